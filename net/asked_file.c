/* Requests the file that the kiosk asked for last, and repeats the request after a pause where the
 * server did not answer. */
#include "net/asked_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

struct asked_file {
	struct asked_file_options options;
	struct message_file file; /* what is asked for; no name: nothing */
	struct buffer body;
	struct http_request *request; /* NULL: none in flight */
	int64_t next_ms;              /* without a request: when to start it */
	uint32_t failures;            /* in a row */
};

int asked_file_create(struct asked_file **out, const struct asked_file_options *options)
{
	struct asked_file *asked = calloc(1, sizeof(*asked));

	*out = asked;
	if (!asked)
		return -ENOMEM;
	asked->options = *options;
	return 0;
}

void asked_file_drop(struct asked_file *asked)
{
	if (asked->request) {
		http_cancel(asked->request);
		asked->options.link->in_flight--;
	}
	asked->request = NULL;
	asked->file.name[0] = '\0';
	buffer_finish(&asked->body);
}

void asked_file_destroy(struct asked_file *asked)
{
	if (!asked)
		return;
	asked_file_drop(asked);
	free(asked);
}

static bool on_piece(void *data, struct bytes piece)
{
	struct asked_file *asked = data;

	buffer_put(&asked->body, piece.data, piece.size);
	return !asked->body.error;
}

static enum file_answer answer_of(int rc, const struct buffer *body)
{
	if (rc == -EBADMSG || body->error)
		return FILE_TOO_LARGE;
	return rc == 0 && body->size > 0 ? FILE_IS_HERE : FILE_NOT_THERE;
}

static void on_done(void *data, const struct http_result *result)
{
	struct asked_file *asked = data;
	struct message_file file = asked->file;
	struct buffer body = asked->body;

	asked->request = NULL;
	asked->options.link->in_flight--;
	if (result->rc == -EHOSTUNREACH) {
		link_failed(asked->options.link, http_url(asked->options.http), result->why);
		asked->next_ms = clock_now_ms() + link_pause_ms(++asked->failures);
		return;
	}
	link_answered(asked->options.link);
	asked->failures = 0;
	if (body.error == -ENOMEM) { /* ours, not the server's */
		asked->next_ms = clock_now_ms() + NO_MEMORY_MS;
		return;
	}
	asked->file.name[0] = '\0';
	asked->body = (struct buffer){ 0 };
	file.answer = answer_of(result->rc, &body);
	if (file.answer == FILE_IS_HERE)
		file.bytes = buffer_bytes(&body);
	asked->options.answered(asked->options.data, &file);
	buffer_finish(&body);
}

static void request(struct asked_file *asked)
{
	char path[MESSAGE_NAME_MAX + 8];
	const struct http_get get = { .path = path,
				      .ceiling = asked->file.bytes_max,
				      .receive = on_piece,
				      .done = on_done,
				      .data = asked };

	snprintf(path, sizeof(path), "tuf/%s", asked->file.name);
	buffer_finish(&asked->body);
	buffer_init(&asked->body, asked->file.bytes_max);
	if (http_get(asked->options.http, &get, &asked->request) < 0)
		asked->next_ms = clock_now_ms() + NO_MEMORY_MS;
	else
		asked->options.link->in_flight++;
}

void asked_file_want(struct asked_file *asked, const struct message_file *file)
{
	if (strcmp(asked->file.name, file->name) == 0 && asked->file.bytes_max == file->bytes_max)
		return;
	asked_file_drop(asked);
	asked->file = *file;
	asked->next_ms = 0;
}

static bool waits(const struct asked_file *asked)
{
	return asked->file.name[0] && !asked->request;
}

void asked_file_work(struct asked_file *asked)
{
	if (waits(asked) && clock_now_ms() >= asked->next_ms &&
	    link_may_request(asked->options.link))
		request(asked);
}

int64_t asked_file_due_ms(const struct asked_file *asked)
{
	const struct link *link = asked->options.link;

	if (!waits(asked) || (link->failures > 0 && link->in_flight > 0))
		return INT64_MAX;
	return asked->next_ms > link->retry_at_ms ? asked->next_ms : link->retry_at_ms;
}
