/* Compares what the client workflow finds with the other signed files, or takes it in their place.
 */
#include "pipeline/release/verify_tuf.h"

#include <errno.h>
#include <string.h>

#include "pipeline/release/tuf_reading.h"

static int complain(struct verify_walk *walk, int rc, const char *why)
{
	return diagnostics_add(&walk->report->diagnostics, rc, "tuf", 0, "%s", why);
}

int verify_tuf(struct verify_walk *walk, struct bytes release_file, const char *target,
	       int64_t now_s)
{
	const uint32_t last = walk->report->release.tuf_root;
	const struct bytes own = { NULL, 0 };
	struct tuf_reading reading;
	struct buffer file;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = release_reader_file(walk->reader, "tuf/1.root.json", &file);
	if (rc == -ENOENT) { /* not signed in this form */
		buffer_finish(&file);
		return last == 0 ? 0
				 : diagnostics_add(&walk->report->diagnostics, -ENOENT, "tuf", 0,
						   "release.json says that there are roots up to "
						   "tuf/%u.root.json, and the first is missing: "
						   "publish again",
						   last);
	}
	buffer_clear(&file);
	rc = tuf_reading_release(&reading, walk->reader, own, target, now_s, NULL, &file);
	if (rc < 0)
		complain(walk, rc, reading.why);
	else if (!bytes_equal(buffer_bytes(&file), release_file))
		rc = complain(walk, -EBADMSG, "its target is another release.json");
	tuf_reading_finish(&reading);
	buffer_finish(&file);
	return rc;
}

int verify_tuf_alone(struct verify_walk *walk, struct bytes root, const char *target, int64_t now_s)
{
	struct verify_report *report = walk->report;
	struct tuf_reading reading;
	struct buffer file;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = tuf_reading_release(&reading, walk->reader, root, target, now_s, &report->release,
				 &file);
	if (rc < 0)
		complain(walk, rc, reading.why);
	report->trust.expires_s = reading.client.root.expires_s;
	report->timestamp.expires_s = reading.client.timestamp.expires_s;
	tuf_reading_finish(&reading);
	buffer_finish(&file);
	return rc;
}
