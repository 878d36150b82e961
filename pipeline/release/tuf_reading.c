/* The files come from the reader; what is to be stored is forgotten. */
#include "pipeline/release/tuf_reading.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tuf/targets.h"

struct source {
	struct release_reader *reader;
	struct buffer root; /* the first one */
};

static int fetch(void *context, const char *name, struct buffer *out)
{
	struct source *source = context;
	char path[256];

	if (snprintf(path, sizeof(path), "tuf/%s", name) >= (int)sizeof(path))
		return -ENAMETOOLONG;
	return release_reader_file(source->reader, path, out);
}

static int load(void *context, const char *name, struct buffer *out)
{
	const struct source *source = context;

	if (strcmp(name, "root.json") != 0)
		return -ENOENT;
	buffer_put(out, source->root.data, source->root.size);
	return out->error;
}

static int store(void *context, const char *name, struct bytes file)
{
	(void)context;
	(void)name;
	(void)file;
	return 0;
}

static int bring(struct tuf_reading *reading, struct source *source, const char *path,
		 struct buffer *file)
{
	struct tuf_target target;
	char name[sizeof(target.file) + 16];
	int rc = tuf_client_find(&reading->client, path, &target);

	if (rc < 0) {
		snprintf(reading->why, sizeof(reading->why), "%s", reading->client.why);
		return rc;
	}
	snprintf(name, sizeof(name), "tuf/targets/%s", target.file);
	rc = release_reader_file(source->reader, name, file);
	if (rc == 0 && !tuf_target_is(&target, buffer_bytes(file)))
		rc = -EBADMSG;
	if (rc < 0)
		snprintf(reading->why, sizeof(reading->why), "%.400s: %s", name,
			 rc == -EBADMSG ? "not the target that was signed" : strerror(-rc));
	tuf_target_finish(&target);
	return rc;
}

int tuf_reading_release(struct tuf_reading *reading, struct release_reader *reader,
			struct bytes root, const char *target, int64_t now_s, struct release *out,
			struct buffer *file)
{
	struct source source = { .reader = reader };
	const struct tuf_io io = { &source, fetch, load, store };
	const char *why = NULL;
	int rc = 0;

	*reading = (struct tuf_reading){ .why = "" };
	buffer_init(&source.root, METADATA_FILE_BYTES_MAX);
	buffer_put(&source.root, root.data, root.size);
	if (root.size == 0)
		rc = release_reader_file(reader, "tuf/1.root.json", &source.root);
	if (rc < 0) {
		snprintf(reading->why, sizeof(reading->why), "%s", release_reader_why(reader));
	} else {
		rc = tuf_client_refresh(&reading->client, &io, now_s > 0 ? now_s : 1);
		snprintf(reading->why, sizeof(reading->why), "%s", reading->client.why);
	}
	if (rc == 0)
		rc = bring(reading, &source, target && *target ? target : "release.json", file);
	if (rc == 0 && out && (rc = release_decode_target(out, buffer_bytes(file), &why)) < 0)
		snprintf(reading->why, sizeof(reading->why), "release.json: %s", why);
	buffer_finish(&source.root);
	return rc == -ETIME ? -EKEYEXPIRED : rc;
}

void tuf_reading_finish(struct tuf_reading *reading)
{
	tuf_client_finish(&reading->client);
}
