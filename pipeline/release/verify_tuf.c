/* The client workflow over the release's reader, with nothing stored but the first root. */
#include "pipeline/release/verify_tuf.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tuf/targets.h"

struct source {
	struct verify_walk *walk;
	struct buffer root; /* tuf/1.root.json */
};

static int fetch(void *context, const char *name, struct buffer *out)
{
	struct source *source = context;
	char path[256];

	if (snprintf(path, sizeof(path), "tuf/%s", name) >= (int)sizeof(path))
		return -ENAMETOOLONG;
	return release_reader_file(source->walk->reader, path, out);
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

static int compare(struct tuf_client *client, struct bytes release_file, const char **why)
{
	struct tuf_target target;
	int rc = tuf_client_find(client, "release.json", &target);

	if (rc == 0 && !tuf_target_is(&target, release_file)) {
		rc = -EBADMSG;
		*why = "its target is another release.json";
	}
	tuf_target_finish(&target);
	return rc;
}

int verify_tuf(struct verify_walk *walk, struct bytes release_file, int64_t now_s)
{
	struct source source = { .walk = walk };
	const struct tuf_io io = { &source, fetch, load, store };
	struct tuf_client client = { 0 };
	const char *why = client.why;
	int rc;

	buffer_init(&source.root, METADATA_FILE_BYTES_MAX);
	rc = release_reader_file(walk->reader, "tuf/1.root.json", &source.root);
	if (rc == -ENOENT) { /* not signed in this form */
		const uint32_t last = walk->report->release.tuf_root;

		buffer_finish(&source.root);
		return last == 0 ? 0
				 : diagnostics_add(&walk->report->diagnostics, -ENOENT, "tuf", 0,
						   "release.json says that there are roots up to "
						   "tuf/%u.root.json, and the first is missing: "
						   "publish again",
						   last);
	}
	if (rc < 0)
		why = release_reader_why(walk->reader);
	else
		rc = tuf_client_refresh(&client, &io, now_s > 0 ? now_s : 1);
	if (rc == 0)
		rc = compare(&client, release_file, &why);
	if (rc < 0)
		diagnostics_add(&walk->report->diagnostics, rc == -ETIME ? -EKEYEXPIRED : rc, "tuf",
				0, "%s", why);
	tuf_client_finish(&client);
	buffer_finish(&source.root);
	return rc;
}
