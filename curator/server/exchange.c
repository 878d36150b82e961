/* The steps of an exchange. */
#include "curator/server/exchange.h"

#include <libwebsockets.h>
#include <string.h>

#include "base/log.h"
#include "curator/server/request_head.h"
#include "curator/server/web_files.h"

enum {
	HEAD_BYTES = 4096,
	PIECE_BYTES = 64 << 10,
	REFUSED_BYTES_MAX = 64 << 10, /* of a body that is read only to answer politely */
	PATIENCE_S = 120,             /* a handler's */
};
static const uint64_t uploads_bytes_max = 4 * API_UPLOAD_BYTES_MAX; /* of all together */

/* What a browser gets is asked for by the page itself, and by nobody else. */
static const char page_policy[] =
	"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
	"media-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";
/* What handlers send is data: a picture that somebody uploaded runs nothing. */
static const char data_policy[] = "default-src 'none'; frame-ancestors 'none'; sandbox";

/* ---- the answer */

static int add_header(struct lws *wsi, const char *name, const char *value, uint8_t **at,
		      uint8_t *end)
{
	return lws_add_http_header_by_name(wsi, (const uint8_t *)name, (const uint8_t *)value,
					   (int)strlen(value), at, end);
}

static int write_head(struct exchange *exchange)
{
	struct lws *wsi = exchange->wsi;
	uint8_t head[LWS_PRE + HEAD_BYTES], *at = head + LWS_PRE, *end = head + sizeof(head) - 1;
	const struct api_response *response = &exchange->job->response;
	const bool is_data = exchange->job->route != NULL;
	int rc = lws_add_http_header_status(wsi, (unsigned)response->status, &at, end);

	if (response->type)
		rc |= add_header(wsi, "content-type:", response->type, &at, end);
	if (response->status != 304)
		rc |= lws_add_http_header_content_length(wsi, exchange->body.size, &at, end);
	rc |= add_header(wsi, "content-security-policy:", is_data ? data_policy : page_policy, &at,
			 end);
	rc |= add_header(wsi, "x-content-type-options:", "nosniff", &at, end);
	rc |= add_header(wsi, "referrer-policy:", "no-referrer", &at, end);
	rc |= add_header(wsi, "cross-origin-resource-policy:", "same-origin", &at, end);
	rc |= add_header(wsi, "cross-origin-opener-policy:", "same-origin", &at, end);
	rc |= add_header(wsi, "cache-control:", is_data ? "no-store" : "no-cache", &at, end);
	for (uint32_t n = 0; n < response->header_count; n++)
		rc |= add_header(wsi, response->headers[n].name, response->headers[n].value, &at,
				 end);
	return rc || lws_finalize_write_http_header(wsi, head + LWS_PRE, &at, end) ? -1 : 0;
}

/* Writes the next piece. Returns 1 when it was the last one. */
static int write_piece(struct exchange *exchange)
{
	const size_t left = exchange->body.size - exchange->sent_bytes,
		     bytes = left < PIECE_BYTES ? left : PIECE_BYTES;
	const enum lws_write_protocol how = bytes == left ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP;

	if (!exchange->output.ceiling)
		buffer_init(&exchange->output, LWS_PRE + PIECE_BYTES);
	buffer_clear(&exchange->output);
	buffer_extend(&exchange->output, LWS_PRE);
	buffer_put(&exchange->output, exchange->body.data + exchange->sent_bytes, bytes);
	if (exchange->output.error ||
	    lws_write(exchange->wsi, exchange->output.data + LWS_PRE, bytes, how) < (int)bytes)
		return -1;
	exchange->sent_bytes += bytes;
	return bytes == left;
}

static int end_exchange(struct exchange *exchange)
{
	struct lws *wsi = exchange->wsi;

	exchange_finish(exchange);
	return lws_http_transaction_completed(wsi) ? -1 : 0;
}

int exchange_write(struct exchange *exchange)
{
	int rc;

	if (exchange->is_at_work && workers_ended(exchange->env->workers, exchange->job)) {
		exchange->is_at_work = false;
		exchange->is_answered = true;
		exchange->body = buffer_bytes(&exchange->job->response.body);
	}
	if (!exchange->job || !exchange->is_answered)
		return 0;
	if (!exchange->job->response.status)
		exchange->job->response.status = 200;
	if (!exchange->has_head) {
		exchange->has_head = true;
		if (write_head(exchange) < 0)
			return -1;
		if (exchange->body.size == 0)
			return end_exchange(exchange);
	} else {
		rc = write_piece(exchange);
		if (rc < 0)
			return -1;
		if (rc > 0)
			return end_exchange(exchange);
	}
	lws_callback_on_writable(exchange->wsi);
	return 0;
}

static void answer(struct exchange *exchange)
{
	exchange->is_answered = true;
	exchange->body = buffer_bytes(&exchange->job->response.body);
	lws_callback_on_writable(exchange->wsi);
}

/* ---- files */

static void answer_file(struct exchange *exchange, const struct web_file *file, bool takes_gzip)
{
	struct api_response *response = &exchange->job->response;
	char tag[HASH_HEX_BYTES + 3];

	snprintf(tag, sizeof(tag), "%s%s", file->tag, takes_gzip ? "-z" : "");
	answer(exchange);
	api_add_header(response, "vary:", "accept-encoding");
	if (api_send_tag(&exchange->job->request, response, tag))
		return;
	response->type = file->type;
	if (takes_gzip)
		api_add_header(response, "content-encoding:", "gzip");
	exchange->body = takes_gzip ? file->zipped : file->bytes;
}

/* ---- routes */

static void refuse_method(struct api_response *response, unsigned allowed)
{
	static const char *const names[] = {
		[API_GET] = "GET", [API_PUT] = "PUT", [API_POST] = "POST", [API_DELETE] = "DELETE"
	};
	char list[64] = "";

	for (unsigned n = 0; n < API_METHOD_COUNT; n++)
		if (allowed & 1u << n)
			snprintf(list + strlen(list), sizeof(list) - strlen(list), "%s%s",
				 *list ? ", " : "", names[n]);
	api_fail(response, 405, "this address takes %s alone", list);
	api_add_header(response, "allow:", "%s", list);
}

/* Finds the route. Returns 0, or -1 with an answer. */
static int find_route(struct exchange *exchange)
{
	struct api_job *job = exchange->job;
	unsigned allowed;

	job->route = route_find(exchange->env->tables, exchange->env->table_count, &job->request,
				&job->user, &allowed);
	if (job->route)
		return 0;
	if (allowed)
		refuse_method(&job->response, allowed);
	else
		api_fail(&job->response, 404, "there is nothing at this address");
	return -1;
}

/* Whether the body that is announced may come. Returns 0, or -1 with an answer. */
static int admit_body(struct exchange *exchange, uint64_t bytes)
{
	struct api_job *job = exchange->job;

	if (bytes > job->route->body_bytes_max) {
		api_fail(&job->response, 413, "at most %u KB can be sent here",
			 job->route->body_bytes_max >> 10);
		return -1;
	}
	if (exchange->env->upload_bytes + bytes > uploads_bytes_max) {
		api_fail(&job->response, 503, "too much is being sent at once: try again");
		return -1;
	}
	exchange->announced_bytes = bytes;
	exchange->env->upload_bytes += bytes;
	buffer_init(&job->request.body, bytes);
	return 0;
}

static void run(struct exchange *exchange)
{
	struct api_job *job = exchange->job;

	if (!job->route->slow) {
		api_job_run(job);
		answer(exchange);
		return;
	}
	if (workers_begin(exchange->env->workers, job) < 0) {
		api_fail(&job->response, 503, "too much is being done at once: try again");
		answer(exchange);
		return;
	}
	exchange->is_at_work = true;
	lws_set_timeout(exchange->wsi, PENDING_TIMEOUT_HTTP_CONTENT, PATIENCE_S);
}

/* Returns 0 if the request may go on, or -1 with an answer. */
static int judge(struct exchange *exchange, const struct request_head *head)
{
	struct api_job *job = exchange->job;

	if (find_route(exchange) < 0 ||
	    access_judge(job->route->role, head, &job->request, &job->response) < 0)
		return -1;
	return head->body_bytes > 0 ? admit_body(exchange, head->body_bytes) : 0;
}

/* Answers without having read a body of any length, and closes. */
static int answer_and_close(struct exchange *exchange)
{
	answer(exchange);
	if (exchange_write(exchange) == 0 && exchange->job) {
		int rc = exchange_write(exchange);
		(void)rc; /* it is closed in any case */
	}
	return -1;
}

static int enlist(struct exchange *exchange, struct exchange_env *env, struct lws *wsi)
{
	exchange->env = env;
	exchange->wsi = wsi;
	exchange->next = env->first;
	exchange->link = &env->first;
	if (env->first)
		env->first->link = &exchange->next;
	env->first = exchange;
	exchange->job = api_job_create();
	return exchange->job ? 0 : -1;
}

/* The page itself is for whoever is signed in, its files are for everybody. Returns whether it is a
 * file, which is then answered. */
static bool begin_file(struct exchange *exchange, const struct request_head *head)
{
	struct api_job *job = exchange->job;
	const struct web_file *file = web_file_find(job->request.path);

	if (!file || job->request.method != API_GET || head->body_bytes > 0)
		return false;
	if (!file->is_open && job->request.caller.role == ROLE_NONE) {
		api_fail(&job->response, 303, "sign in first");
		api_add_header(&job->response, "location:", "/sign-in");
		answer(exchange);
	} else {
		answer_file(exchange, file, head->takes_gzip);
	}
	return true;
}

/* Reads the headers. Returns -1 if there is an answer already, after which the connection must be
 * closed. */
static int read_head(struct exchange *exchange, struct request_head *head, const char *path)
{
	struct api_job *job = exchange->job;
	const int status = request_head_read(head, &job->request, exchange->wsi, path,
					     &exchange->env->access->head);

	if (status == 0)
		return 0;
	api_fail(&job->response, status, "the request is not one that is answered here");
	return -1;
}

int exchange_begin(struct exchange *exchange, struct exchange_env *env, struct lws *wsi,
		   const char *path)
{
	struct request_head head;
	struct api_job *job;
	bool may_go_on;

	exchange_finish(exchange);
	if (enlist(exchange, env, wsi) < 0)
		return -1;
	job = exchange->job;
	if (read_head(exchange, &head, path) < 0)
		return answer_and_close(exchange);
	may_go_on = access_identify(env->access, &head, &job->request, &job->response) == 0;
	if (may_go_on && begin_file(exchange, &head))
		return 0;
	exchange->has_body = head.body_bytes > 0;
	if (may_go_on && judge(exchange, &head) == 0) {
		if (!exchange->has_body)
			run(exchange);
		return 0;
	}
	if (head.body_bytes > REFUSED_BYTES_MAX)
		return answer_and_close(exchange);
	if (!exchange->has_body)
		answer(exchange);
	return 0;
}

/* A body that was refused is dropped: the answer is there already. */
int exchange_take_body(struct exchange *exchange, const void *piece, size_t bytes)
{
	if (!exchange->job || !exchange->has_body)
		return bytes == 0 ? 0 : -1;
	if (exchange->announced_bytes > 0)
		buffer_put(&exchange->job->request.body, piece, bytes);
	return exchange->job->request.body.error ? -1 : 0;
}

int exchange_end_body(struct exchange *exchange)
{
	if (!exchange->job || !exchange->has_body)
		return 0; /* it was empty */
	exchange->has_body = false;
	if (exchange->announced_bytes == 0)
		answer(exchange);
	else
		run(exchange);
	return 0;
}

void exchange_wake(const struct exchange_env *env)
{
	for (const struct exchange *at = env->first; at; at = at->next)
		if (at->is_at_work)
			lws_callback_on_writable(at->wsi);
}

void exchange_finish(struct exchange *exchange)
{
	if (!exchange->env)
		return;
	*exchange->link = exchange->next;
	if (exchange->next)
		exchange->next->link = exchange->link;
	exchange->env->upload_bytes -= exchange->announced_bytes;
	if (exchange->is_at_work)
		workers_abandon(exchange->env->workers, exchange->job);
	else
		api_job_destroy(exchange->job);
	buffer_finish(&exchange->output);
	*exchange = (struct exchange){ 0 };
}
