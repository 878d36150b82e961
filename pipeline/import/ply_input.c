/* Buffered input for the PLY reader: views of binary data, and fast parsing of ASCII numbers. */
#include "pipeline/import/ply_input.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pipeline/import/ply_header.h"

int ply_input_init(struct ply_input *input, int fd)
{
	struct stat status;

	*input = (struct ply_input){ .fd = fd, .line = 1 };
	if (fstat(fd, &status) < 0)
		return -errno;
	/* Only a regular file has a known length, against which the header's counts are checked. */
	if (!S_ISREG(status.st_mode))
		return S_ISDIR(status.st_mode) ? -EISDIR : -ESPIPE;
	input->file_bytes = (uint64_t)status.st_size;
	input->buffer = malloc(PLY_BUFFER_BYTES);
	return input->buffer ? 0 : -ENOMEM;
}

void ply_input_finish(struct ply_input *input)
{
	if (input->fd >= 0)
		close(input->fd);
	free(input->buffer);
	*input = (struct ply_input){ .fd = -1 };
}

/* Moves the remaining bytes to the front and reads until `size` bytes are there or the file
 * ends. */
static bool refill(struct ply_input *input, size_t size)
{
	memmove(input->buffer, input->buffer + input->at, input->end - input->at);
	input->base += input->at;
	input->end -= input->at;
	input->at = 0;
	while (input->end < size && !input->error) {
		ssize_t got =
			read(input->fd, input->buffer + input->end, PLY_BUFFER_BYTES - input->end);

		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			input->error = -errno;
		if (got <= 0)
			break;
		input->end += (size_t)got;
	}
	return input->end >= size;
}

const uint8_t *ply_input_take(struct ply_input *input, size_t size)
{
	const uint8_t *view;

	if (input->end - input->at < size && !refill(input, size))
		return NULL;
	view = input->buffer + input->at;
	input->at += size;
	return view;
}

int ply_input_peek(struct ply_input *input)
{
	if (input->at == input->end && !refill(input, 1))
		return -1;
	return input->buffer[input->at];
}

uint64_t ply_input_offset(const struct ply_input *input)
{
	return input->base + input->at;
}

int ply_input_seek(struct ply_input *input, uint64_t offset)
{
	input->at = input->end = 0;
	input->base = offset;
	return lseek(input->fd, (off_t)offset, SEEK_SET) < 0 ? -errno : 0;
}

/* ---- numbers */

static bool is_blank(int c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static bool is_line_end(const struct ply_input *input, int c)
{
	return c == '\n' || (c == '\r' && input->cr_only);
}

/* Parses a decimal number exactly if its digits fit into 53 bits and the power of ten is exact in a
 * double (Clinger's fast path, 1990). Returns false otherwise; strtod then does it, ten times
 * slower. */
static bool parse_simple(const char *text, double *out)
{
	static const double powers[] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
					 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
					 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22 };
	const char *c = text;
	bool negative = *c == '-';
	uint64_t digits = 0;
	int exponent = 0, seen = 0;

	if (*c == '-' || *c == '+')
		c++;
	for (; *c >= '0' && *c <= '9'; c++, seen++)
		digits = digits * 10 + (uint64_t)(*c - '0');
	if (*c == '.')
		for (c++; *c >= '0' && *c <= '9'; c++, seen++, exponent--)
			digits = digits * 10 + (uint64_t)(*c - '0');
	if (seen == 0 || seen > 18 || *c || digits >> 53 || exponent < -22)
		return false;
	*out = (double)digits / powers[-exponent];
	if (negative)
		*out = -*out;
	return true;
}

static enum ply_token parse(const char *text, double *out)
{
	char *end;

	if (parse_simple(text, out))
		return PLY_TOKEN_NUMBER;
	*out = strtod(text, &end);
	return end != text && *end == '\0' ? PLY_TOKEN_NUMBER : PLY_TOKEN_BAD;
}

enum ply_token ply_input_number(struct ply_input *input, bool cross_lines, double *out,
				char text[PLY_TOKEN_BYTES])
{
	size_t length = 0;
	int c;

	while ((c = ply_input_peek(input)) >= 0 && (is_blank(c) || c == '\n')) {
		const bool ends = is_line_end(input, c);

		if (ends && !cross_lines)
			return PLY_TOKEN_LINE_END;
		input->line += ends;
		input->at++;
	}
	if (c < 0)
		return PLY_TOKEN_FILE_END;
	while ((c = ply_input_peek(input)) >= 0 && !is_blank(c) && c != '\n') {
		if (length == PLY_TOKEN_BYTES - 1)
			break;
		text[length++] = (char)c;
		input->at++;
	}
	text[length] = '\0';
	if (length == PLY_TOKEN_BYTES - 1 || memchr(text, '\0', length))
		return PLY_TOKEN_BAD;
	return parse(text, out);
}
