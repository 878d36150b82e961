/* Opens a content folder for sessions. */
#include "curator/session/site.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/build.h"

/* Its faults name a line, but not the file. */
static int read_settings(struct site *site, const char *folder, struct diagnostics *diagnostics)
{
	struct diagnostics found = { 0 };
	char file[CONTENT_PATH_BYTES];
	int rc = content_read(&site->content, folder, &found);

	snprintf(file, sizeof(file), "%s/temple.ini", folder);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, file, 0, "%s", diagnostics_cause(&found, rc));
	diagnostics_finish(&found);
	return rc;
}

int site_open(struct site *site, const char *folder, struct diagnostics *diagnostics)
{
	const struct scans_shape *shape = NULL;
	int rc;

	*site = (struct site){ 0 };
	rc = read_settings(site, folder, diagnostics);
	if (rc == 0)
		rc = scans_create(&site->scans, &site->content);
	if (rc == 0)
		build_known_master(&site->master, site->scans);
	if (rc == 0 && !site->master)
		rc = diagnostics_add(diagnostics, -ENOENT, folder, 0,
				     "has no hierarchy of its scans: make it with 'gopura-content "
				     "hierarchy %s'",
				     folder);
	if (rc == 0)
		rc = scans_get_mesh(site->scans, &site->mesh, diagnostics);
	if (rc == 0)
		rc = scans_get_shape(site->scans, &shape, diagnostics);
	if (rc == 0)
		rc = face_blocks_make(&site->blocks, site->mesh);
	if (rc == 0)
		rc = documents_open(&site->documents, folder, diagnostics);
	if (rc < 0) {
		site_close(site);
		return rc;
	}
	/* A closed surface has no pictures, but the colours that they had: as a release judges. */
	site->lit = content_is_lit(&site->content, shape->had_pictures);
	return 0;
}

bool site_has_other_scans(const struct site *site)
{
	struct diagnostics found = { 0 };
	struct scans *now = NULL;
	struct content content;
	struct hash opened, key;
	/* With faults in temple.ini, nothing is built of what is there now. */
	const bool changed = content_read(&content, site->content.folder, &found) == 0 &&
			     scans_create(&now, &content) == 0 && scans_key(now, &key, NULL) == 0 &&
			     scans_key(site->scans, &opened, NULL) == 0 && !hash_equal(opened, key);

	scans_destroy(now);
	content_release(&content);
	diagnostics_finish(&found);
	return changed;
}

void site_close(struct site *site)
{
	if (!site->content.folder[0])
		return;
	face_blocks_finish(&site->blocks);
	master_destroy(site->master);
	scans_destroy(site->scans);
	content_release(&site->content);
	documents_close(site->documents);
	*site = (struct site){ 0 };
}
