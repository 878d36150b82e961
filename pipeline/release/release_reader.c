/* Reads the files of a release from disk or with libcurl, keeps a few packs in memory, and checks
 * the hash of everything it returns. */
#include "pipeline/release/release_reader.h"

#include <curl/curl.h>
#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A breadth-first walk stays in one pack, and sometimes visits one of an older release. */
enum { PACKS_KEPT = 4, FILE_BYTES_MAX = 1 << 30 };

struct kept_pack {
	struct hash name;
	struct buffer bytes;
	uint64_t used; /* the reader's count of calls when it was used last; 0: empty */
};

struct release_reader {
	char place[PATH_MAX]; /* without a final / */
	bool is_url;
	CURL *curl;
	struct kept_pack packs[PACKS_KEPT];
	uint64_t calls, bytes;
	char why[1024];
};

static int blame(struct release_reader *reader, int rc, const char *text, ...) printf_like(3, 4);

static int blame(struct release_reader *reader, int rc, const char *text, ...)
{
	va_list args;

	va_start(args, text);
	vsnprintf(reader->why, sizeof(reader->why), text, args);
	va_end(args);
	return rc;
}

/* ---- over the network ---- */

static size_t receive(char *data, size_t one, size_t size, void *out)
{
	struct buffer *buffer = out;

	buffer_put(buffer, data, one * size);
	return buffer->error ? 0 : one * size;
}

static int start_curl(struct release_reader *reader, const char *ca_file)
{
	CURLcode code = curl_global_init(CURL_GLOBAL_DEFAULT);

	reader->curl = code == CURLE_OK ? curl_easy_init() : NULL;
	if (!reader->curl)
		return -ENOMEM;
	if (ca_file)
		code = curl_easy_setopt(reader->curl, CURLOPT_CAINFO, ca_file);
	if (code == CURLE_OK)
		code = curl_easy_setopt(reader->curl, CURLOPT_WRITEFUNCTION, receive);
	if (code == CURLE_OK)
		code = curl_easy_setopt(reader->curl, CURLOPT_PROTOCOLS_STR, "http,https");
	if (code == CURLE_OK)
		code = curl_easy_setopt(reader->curl, CURLOPT_HTTP_VERSION, CURL_HTTP_VERSION_2TLS);
	if (code == CURLE_OK)
		code = curl_easy_setopt(reader->curl, CURLOPT_FOLLOWLOCATION, 0L);
	/* A transfer that stalls for a minute has failed; a slow one has not. */
	if (code == CURLE_OK)
		code = curl_easy_setopt(reader->curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
	if (code == CURLE_OK)
		code = curl_easy_setopt(reader->curl, CURLOPT_LOW_SPEED_TIME, 60L);
	if (code == CURLE_OK)
		code = curl_easy_setopt(reader->curl, CURLOPT_CONNECTTIMEOUT, 30L);
	return code == CURLE_OK ? 0 : -EIO;
}

static int fetch(struct release_reader *reader, const char *url, struct buffer *out)
{
	long status = 0;
	CURLcode code = curl_easy_setopt(reader->curl, CURLOPT_URL, url);

	if (code == CURLE_OK)
		code = curl_easy_setopt(reader->curl, CURLOPT_WRITEDATA, out);
	if (code == CURLE_OK)
		code = curl_easy_perform(reader->curl);
	if (out->error)
		return blame(reader, out->error, "%s: %s", url, strerror(-out->error));
	if (code != CURLE_OK)
		return blame(reader, -EIO, "%s: %s", url, curl_easy_strerror(code));
	curl_easy_getinfo(reader->curl, CURLINFO_RESPONSE_CODE, &status);
	if (status == 404)
		return blame(reader, -ENOENT, "%s: not found", url);
	if (status != 200)
		return blame(reader, -EIO, "%s: the server answered %ld", url, status);
	return 0;
}

/* ---- files ---- */

int release_reader_create(struct release_reader **out, const struct release_reader_options *options)
{
	struct release_reader *reader = calloc(1, sizeof(*reader));
	size_t length = strlen(options->place);
	int rc = 0;

	*out = NULL;
	if (!reader)
		return -ENOMEM;
	for (int i = 0; i < PACKS_KEPT; i++)
		buffer_init(&reader->packs[i].bytes, FILE_BYTES_MAX);
	while (length > 1 && options->place[length - 1] == '/')
		length--;
	if (length >= sizeof(reader->place))
		rc = -ENAMETOOLONG;
	else
		memcpy(reader->place, options->place, length);
	reader->is_url = strncmp(reader->place, "http://", 7) == 0 ||
			 strncmp(reader->place, "https://", 8) == 0;
	if (rc == 0 && reader->is_url)
		rc = start_curl(reader, options->ca_file);
	if (rc < 0) {
		release_reader_destroy(reader);
		return rc;
	}
	*out = reader;
	return 0;
}

void release_reader_destroy(struct release_reader *reader)
{
	if (!reader)
		return;
	for (int i = 0; i < PACKS_KEPT; i++)
		buffer_finish(&reader->packs[i].bytes);
	if (reader->is_url) {
		curl_easy_cleanup(reader->curl);
		curl_global_cleanup();
	}
	free(reader);
}

int release_reader_file(struct release_reader *reader, const char *name, struct buffer *out)
{
	char path[PATH_MAX + 256];
	int rc;

	snprintf(path, sizeof(path), "%s/%s", reader->place, name);
	buffer_clear(out);
	rc = reader->is_url ? fetch(reader, path, out) : buffer_read_file(out, path);
	if (rc < 0 && !reader->is_url)
		rc = blame(reader, rc, "%s: %s", path, strerror(-rc));
	reader->bytes += out->size;
	return rc;
}

static struct kept_pack *oldest(struct release_reader *reader)
{
	struct kept_pack *pack = &reader->packs[0];

	for (int i = 1; i < PACKS_KEPT; i++)
		if (reader->packs[i].used < pack->used)
			pack = &reader->packs[i];
	return pack;
}

int release_reader_pack(struct release_reader *reader, struct hash name, struct bytes *out)
{
	struct kept_pack *pack;
	char file[64] = "packs/";
	int rc;

	reader->calls++;
	for (int i = 0; i < PACKS_KEPT; i++) {
		pack = &reader->packs[i];
		if (pack->used && hash_equal(pack->name, name)) {
			pack->used = reader->calls;
			*out = buffer_bytes(&pack->bytes);
			return 0;
		}
	}
	pack = oldest(reader);
	pack->used = 0;
	hash_to_hex(name, file + strlen(file));
	rc = release_reader_file(reader, file, &pack->bytes);
	if (rc < 0)
		return rc;
	if (!hash_equal(hash_of(buffer_bytes(&pack->bytes)), name))
		return blame(reader, -EBADMSG, "%s: damaged: does not hash to its name", file);
	pack->name = name;
	pack->used = reader->calls;
	*out = buffer_bytes(&pack->bytes);
	return 0;
}

int release_reader_child(struct release_reader *reader, const struct locator *locator,
			 struct hash page, uint64_t offset, const struct page_child *child,
			 struct bytes *out)
{
	const struct locator_block *block = locator_find(locator, page);
	char page_hex[HASH_HEX_BYTES], hex[HASH_HEX_BYTES];
	struct bytes pack;
	int rc;

	hash_to_hex(page, page_hex);
	hash_to_hex(child->hash, hex);
	if (!block)
		return blame(reader, -ENOENT, "the locator has no block of page %s", page_hex);
	if (offset + child->size > block->size)
		return blame(reader, -EBADMSG,
			     "object %s lies past the end of the block of page %s", hex, page_hex);
	rc = release_reader_pack(reader, locator->packs[block->pack], &pack);
	if (rc < 0)
		return rc;
	if ((uint64_t)block->offset + block->size > pack.size)
		return blame(reader, -EBADMSG, "the block of page %s lies past the end of its pack",
			     page_hex);
	*out = (struct bytes){ pack.data + block->offset + offset, child->size };
	if (!hash_equal(hash_of(*out), child->hash))
		return blame(reader, -EBADMSG,
			     "object %s, child of page %s: its bytes do not hash to its name", hex,
			     page_hex);
	return 0;
}

const char *release_reader_why(const struct release_reader *reader)
{
	return reader->why;
}

uint64_t release_reader_bytes(const struct release_reader *reader)
{
	return reader->bytes;
}
