/* Shares a budget between triangles and pictures. */
#include "pipeline/texmesh/texmesh.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/texmesh/glb.h"
#include "pipeline/texmesh/mean_colours.h"
#include "pipeline/texmesh/texture_budget.h"
#include "pipeline/texmesh/vertex_scales.h"

enum { ROUNDS = 8, TRIANGLES_LEAST = 20 };

/* What triangles get where there are pictures. A picture needs more bytes for what it shows
 * (section 3 of the paper); what it cannot use goes back to the triangles. */
static const double mesh_share = 0.4;

/* Where seams do not let go, what lies between them is flattened for nothing: of Venus the last
 * tenth of the triangles makes the error ten times as large. So such a mesh keeps so many times the
 * triangles that it can be brought to; the second number where the first does not fit. */
static const double seam_shares[] = { 1.2, 1.05 };

/* Bytes of the description, generously: of a file without materials, and of each material. */
enum { DESCRIPTION_BYTES = 1400, MATERIAL_BYTES = 500 };

struct maker {
	const struct mesh *scan;
	const struct texmesh_options *options;
	struct reduced_mesh whole, reduced;
	uint8_t *scales; /* of the vertices of whole; NULL: not needed */
	struct buffer *jpegs;
	uint64_t overhead_bytes;
	double seam_share;
};

static bool has_pictures(const struct maker *maker)
{
	const struct mesh *scan = maker->scan;

	for (uint32_t i = 0; maker->whole.uvs && i < scan->texture_count; i++)
		if (!mesh_texture_is_colour(&scan->textures[i]))
			return true;
	return false;
}

/* ---- triangles */

static int try_triangles(struct maker *maker, uint32_t count, uint64_t *bytes)
{
	int rc;

	reduced_mesh_finish(&maker->reduced);
	rc = reduced_mesh_make(&maker->reduced, &maker->whole, count);
	*bytes = rc == 0 ? glb_mesh_bytes(&maker->reduced, maker->options->lit) : 0;
	return rc;
}

/* Makes the mesh with the most triangles that takes at most so many bytes, but for 3 %; with more
 * than that where seams do not let go. */
static int fit_triangles(struct maker *maker, uint64_t most_bytes)
{
	const uint32_t all = maker->whole.triangle_count;
	double low = 0, high = (double)all + 1, next = (double)most_bytes / 20;
	uint64_t bytes = 0;

	for (int round = 0; round < ROUNDS; round++) {
		next = next < TRIANGLES_LEAST ? TRIANGLES_LEAST : next < all ? next : all;
		int rc = try_triangles(maker, (uint32_t)next, &bytes);
		const uint32_t got = maker->reduced.triangle_count;

		if (rc < 0)
			return rc;
		if (bytes <= most_bytes) {
			if ((double)bytes >= 0.97 * (double)most_bytes || got == all)
				return 0;
			low = next;
		} else {
			if (next <= TRIANGLES_LEAST)
				return 0;
			if ((double)got > 1.02 * next + 8) {
				const double kept = maker->seam_share * got;

				return try_triangles(maker, kept < all ? (uint32_t)kept : all,
						     &bytes);
			}
			high = next;
		}
		next *= 0.985 * (double)most_bytes / (double)bytes;
		if (next <= low || next >= high)
			next = (low + high) / 2;
	}
	/* too few rather than too many */
	return bytes > most_bytes && low > 0 ? try_triangles(maker, (uint32_t)low, &bytes) : 0;
}

/* ---- both */

static int fit_both(struct maker *maker, struct texmesh_report *report)
{
	const uint64_t budget = maker->options->budget_bytes - maker->overhead_bytes;
	struct texture_options textures = { .scan = maker->scan,
					    .copy = &maker->whole,
					    .scales = maker->scales };
	struct texture_result result = { 0 };
	const bool pictured = has_pictures(maker);
	int rc = fit_triangles(maker, pictured ? (uint64_t)(mesh_share * (double)budget) : budget);

	if (rc < 0)
		return rc;
	report->mesh_bytes = glb_mesh_bytes(&maker->reduced, maker->options->lit);
	if (pictured) {
		textures.budget_bytes =
			budget > report->mesh_bytes ? budget - report->mesh_bytes : 1;
		rc = texture_budget_meet(maker->jpegs, &result, &textures);
		if (rc == 0 && result.is_best)
			rc = fit_triangles(maker, budget - result.bytes);
	}
	report->mesh_bytes = glb_mesh_bytes(&maker->reduced, maker->options->lit);
	report->picture_bytes = result.bytes;
	report->picture_count = result.picture_count;
	report->fragment_count = result.fragment_count;
	report->halvings = result.halvings;
	report->scale = result.scale;
	report->quality = result.quality;
	report->quality_least = result.least;
	report->quality_most = result.most;
	if (rc == 0 && report->mesh_bytes + report->picture_bytes > budget)
		rc = -E2BIG;
	report->least_bytes = report->mesh_bytes + report->picture_bytes + maker->overhead_bytes;
	return rc;
}

static int fit_all(struct maker *maker, struct texmesh_report *report)
{
	int rc = -E2BIG;

	for (size_t i = 0; i < ARRAY_COUNT(seam_shares) && rc == -E2BIG; i++) {
		maker->seam_share = seam_shares[i];
		rc = fit_both(maker, report);
	}
	return rc;
}

static int write(struct buffer *out, const struct maker *maker)
{
	const struct reduced_mesh *mesh = &maker->reduced;
	struct glb_options options = { .lit = maker->options->lit };
	struct glb_material *materials = calloc(mesh->material_count, sizeof(*materials));
	int rc;

	if (!materials)
		return -ENOMEM;
	for (uint32_t m = 0; m < mesh->material_count; m++) {
		const uint8_t white[3] = { 255, 255, 255 };

		/* colours of vertices are multiplied with that of the material */
		if (!mesh->uvs)
			memcpy(materials[m].rgb, mesh->colours ? white : mesh->colour,
			       sizeof(materials[m].rgb));
		else if (maker->jpegs[m].size > 0)
			materials[m].jpeg = buffer_bytes(&maker->jpegs[m]);
		else
			memcpy(materials[m].rgb, maker->scan->textures[m].rgb,
			       sizeof(materials[m].rgb));
	}
	options.materials = materials;
	rc = glb_write(out, mesh, &options);
	free(materials);
	return rc;
}

int texmesh_make(struct buffer *out, const struct mesh *mesh, const struct texmesh_options *options,
		 struct texmesh_report *report)
{
	struct maker maker = { .scan = mesh, .options = options };
	int rc = mesh->triangle_count > 0 ? 0 : -EINVAL;

	*report = (struct texmesh_report){ .source_triangles = mesh->triangle_count };
	if (rc == 0)
		rc = reduced_mesh_copy(&maker.whole, mesh, options->look);
	if (rc == 0 && has_pictures(&maker) && !options->uniform) {
		maker.scales = malloc((size_t)maker.whole.vertex_count + 1);
		rc = maker.scales ? vertex_scales_find(maker.scales, &maker.whole, mesh) : -ENOMEM;
	}
	if (rc == 0) {
		maker.jpegs = calloc((size_t)mesh->texture_count + 1, sizeof(*maker.jpegs));
		maker.overhead_bytes =
			DESCRIPTION_BYTES + (uint64_t)MATERIAL_BYTES * maker.whole.material_count;
		rc = maker.jpegs ? 0 : -ENOMEM;
	}
	if (rc == 0 && maker.overhead_bytes >= options->budget_bytes) {
		report->least_bytes = 2 * maker.overhead_bytes;
		rc = -E2BIG;
	} else if (rc == 0) {
		rc = fit_all(&maker, report);
	}
	if (rc == 0 && maker.reduced.colours &&
	    maker.reduced.triangle_count < maker.whole.triangle_count)
		rc = mean_colours(&maker.reduced, &maker.whole);
	if (rc == 0)
		rc = write(out, &maker);
	report->triangle_count = maker.reduced.triangle_count;
	report->vertex_count = maker.reduced.vertex_count;
	for (uint32_t i = 0; maker.jpegs && i < mesh->texture_count; i++)
		buffer_finish(&maker.jpegs[i]);
	free(maker.jpegs);
	free(maker.scales);
	reduced_mesh_finish(&maker.reduced);
	reduced_mesh_finish(&maker.whole);
	return rc;
}
