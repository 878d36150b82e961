/* The scans of a content folder as one mesh. What a process asks for is found once: the key when it
 * is first needed, the mesh when nothing less will do. Much needs only the key and the shape, so a
 * build that changes a page reads no mesh. One thread. */
#ifndef GOPURA_PIPELINE_CONTENT_SCANS_H
#define GOPURA_PIPELINE_CONTENT_SCANS_H

#include "pipeline/content/content.h"

struct scans;

/* What can be said of the mesh without having it in memory; kept in .work/shape. */
struct scans_shape {
	float low_m[3], high_m[3]; /* bounding box */
	bool has_textures;
	bool had_pictures; /* the scans have; a surface that was made of them has colours instead */
	uint32_t scan_count;
	/* as counted in each scan's file; 0: its faces have no numbers */
	uint32_t face_counts[CONTENT_SCANS_MAX];
};

/* The surface that is made of scans which are none (pipeline/content/scan_surface.h). */
struct scans_surface {
	uint32_t scan_count;               /* scans that become part of it; 0: there is none */
	uint64_t point_count;              /* of range images and clouds */
	bool is_points[CONTENT_SCANS_MAX]; /* whether a scan is one of these */
	bool is_made;
};

/* Opens nothing yet. content is borrowed for the lifetime. *out is owned by the caller; NULL on
 * failure. -ENOMEM, logged. */
must_check int scans_create(struct scans **out, const struct content *content);
void scans_destroy(struct scans *scans); /* NULL is fine */
const struct content *scans_content(const struct scans *scans);

/* Hashes everything the mesh is made from: names, sizes and modification times of the scans and of
 * the files beside and below (mtl, pictures, buffers), transforms, and the import options. Equal
 * keys mean equal meshes. Negative errno, with a diagnostic. */
must_check int scans_key(struct scans *scans, struct hash *out, struct diagnostics *diagnostics);

/* Says what surface is to be made. Reads headers only. */
void scans_surface(struct scans *scans, struct scans_surface *out);
/* Makes that surface, unless it is there or none is needed; otherwise the import makes it. All
 * scans are checked before, as far as their headers tell. *made: it was made. Negative errno, with
 * a diagnostic. */
must_check int scans_make_surface(struct scans *scans, bool *made, struct diagnostics *diagnostics);

/* Gets the shape; the scans are imported only if nobody has imported them yet. *out is borrowed for
 * the lifetime. Negative errno, with a diagnostic. */
must_check int scans_get_shape(struct scans *scans, const struct scans_shape **out,
			       struct diagnostics *diagnostics);
/* Returns the shape if it is known already, else NULL. Reads no scan. */
const struct scans_shape *scans_known_shape(struct scans *scans);

/* Gets the mesh: from .work/mesh if its key matches, otherwise imported, repaired and saved there.
 * It stays in memory until scans_drop_mesh; *out is borrowed until then. Negative errno, with
 * diagnostic; -ESTALE: a scan was changed since its key was made, so nothing is kept. */
must_check int scans_get_mesh(struct scans *scans, const struct mesh **out,
			      struct diagnostics *diagnostics);
/* Reads what the import reported of each scan, in the order of temple.ini; kept in .work/imported.
 * reports has room for CONTENT_SCANS_MAX; returns how many there are, or -ENOENT if the scans have
 * not been imported since they changed. -ENOMEM and errors of the disk. */
must_check int scans_get_reports(struct scans *scans, struct import_report *reports);
/* Frees the mesh, if it is in memory. The last user calls it. */
void scans_drop_mesh(struct scans *scans);

#endif
