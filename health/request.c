/* Parses the head of an HTTP request strictly, and finds the page that it asks for. */
#include "health/request.h"

#include <string.h>

/* Returns whether text is a token of RFC 9110, section 5.6.2: the syntax of methods and field
 * names. */
static bool is_token(struct bytes text)
{
	for (size_t i = 0; i < text.size; i++) {
		const uint8_t c = text.data[i];

		if (c <= ' ' || c >= 0x7f || strchr("\"(),/:;<=>?@[\\]{}", c))
			return false;
	}
	return text.size > 0;
}

static bool is(struct bytes text, const char *word)
{
	return text.size == strlen(word) && memcmp(text.data, word, text.size) == 0;
}

/* Takes the text up to the mark, and skips the mark. Returns false if there is no mark. */
static bool take_until(struct bytes *rest, const char *mark, struct bytes *out)
{
	const size_t size = strlen(mark);
	const uint8_t *at = rest->size ? memmem(rest->data, rest->size, mark, size) : NULL;

	if (!at)
		return false;
	*out = (struct bytes){ rest->data, (size_t)(at - rest->data) };
	rest->data += out->size + size;
	rest->size -= out->size + size;
	return true;
}

static bool has_controls(struct bytes text)
{
	for (size_t i = 0; i < text.size; i++)
		if ((text.data[i] < ' ' && text.data[i] != '\t') || text.data[i] == 0x7f)
			return true;
	return false;
}

static int find_page(struct request *out, struct bytes target)
{
	static const struct {
		const char *path;
		enum request_page page;
	} pages[] = {
		{ "/", REQUEST_OVERVIEW },
		{ "/metrics", REQUEST_METRICS },
		{ "/health", REQUEST_HEALTH },
		{ "/visits.csv", REQUEST_VISITS },
	};
	const uint8_t *query = memchr(target.data, '?', target.size);
	const struct bytes path = { target.data,
				    query ? (size_t)(query - target.data) : target.size };

	for (size_t i = 0; i < ARRAY_COUNT(pages); i++)
		if (is(path, pages[i].path)) {
			out->page = pages[i].page;
			return 200;
		}
	return 404;
}

static int parse_line(struct request *out, struct bytes line)
{
	struct bytes method, target;

	if (has_controls(line) || !take_until(&line, " ", &method) ||
	    !take_until(&line, " ", &target) || !is_token(method) || target.size == 0 ||
	    line.size != 8 || memcmp(line.data, "HTTP/", 5) != 0)
		return 400;
	if (!is(line, "HTTP/1.1") && !is(line, "HTTP/1.0"))
		return 505;
	out->head = is(method, "HEAD");
	if (!out->head && !is(method, "GET"))
		return 405;
	return target.data[0] == '/' ? find_page(out, target) : 400;
}

int request_parse(struct request *out, struct bytes received)
{
	struct bytes rest = received, head, line, name;
	int status;

	if (!take_until(&rest, "\r\n\r\n", &head))
		return received.size >= REQUEST_BYTES_MAX ? 431 : 0;
	head.size += 2; /* with the end of the last line */
	if (head.size > REQUEST_BYTES_MAX || !take_until(&head, "\r\n", &line))
		return 431;
	status = parse_line(out, line);
	while (status != 400 && take_until(&head, "\r\n", &line))
		if (has_controls(line) || !take_until(&line, ":", &name) || !is_token(name))
			status = 400;
	return status;
}
