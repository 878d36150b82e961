/* Turns the patches of a group into its object and its rows of the hierarchy, with bounding spheres
 * and normal cones. */
#include "pipeline/hierarchy/multires_write.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"
#include "format/patch.h"
#include "pipeline/hierarchy/normal_cone.h"

static double distance(const double a[3], const double b[3])
{
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];

	return sqrt(x * x + y * y + z * z);
}

/* Numbers the vertices of a patch as its triangles name them: out->indices, and named, of 3 a
 * triangle. */
static void name_vertices(struct patch_mesh *out, uint32_t *named, const struct live_patch *patch,
			  uint32_t *local_of)
{
	for (uint32_t i = 0; i < 3 * patch->triangle_count; i++) {
		uint32_t vertex = patch->triangles[i / 3][i % 3], *name = &local_of[vertex];

		if (*name == NO_GROUP) {
			named[out->vertex_count] = vertex;
			*name = out->vertex_count++;
		}
		out->indices[i] = (uint16_t)*name;
	}
	for (uint32_t v = 0; v < out->vertex_count; v++)
		local_of[named[v]] = NO_GROUP;
}

static int fill_mesh(struct patch_mesh *out, const struct lattice_mesh *mesh,
		     const struct live_patch *patch, uint32_t *local_of)
{
	size_t count = 3 * (size_t)patch->triangle_count;
	uint32_t *named = malloc(count * sizeof(*named));

	*out = (struct patch_mesh){ .triangle_count = patch->triangle_count,
				    .indices = malloc(count * sizeof(*out->indices)) };
	if (named && out->indices) {
		name_vertices(out, named, patch, local_of);
		out->vertices = calloc(out->vertex_count, sizeof(*out->vertices));
	}
	for (uint32_t v = 0; out->vertices && v < out->vertex_count; v++) {
		const struct lattice_vertex *from = &mesh->vertices[named[v]];
		struct patch_vertex *to = &out->vertices[v];

		memcpy(to->position, from->position, sizeof(to->position));
		memcpy(to->colour, from->colour, sizeof(to->colour));
		normal_encode(to->normal, from->normal);
	}
	free(named);
	return out->vertices ? 0 : -ENOMEM;
}

static void bound_patch(struct hierarchy_patch *out, const struct patch_mesh *patch,
			const struct lattice *lattice)
{
	int32_t low[3] = { INT32_MAX, INT32_MAX, INT32_MAX }, high[3] = { 0 };
	double centre[3], at[3], radius = 0.0;

	for (uint32_t v = 0; v < patch->vertex_count; v++)
		for (int i = 0; i < 3; i++) {
			int32_t p = patch->vertices[v].position[i];

			low[i] = p < low[i] ? p : low[i];
			high[i] = p > high[i] ? p : high[i];
		}
	for (int i = 0; i < 3; i++) {
		out->centre_m[i] =
			(float)(lattice->origin_m[i] + lattice->step_m * (low[i] + high[i]) / 2.0);
		centre[i] = out->centre_m[i];
	}
	for (uint32_t v = 0; v < patch->vertex_count; v++) {
		lattice_metres(at, lattice, patch->vertices[v].position);
		radius = fmax(radius, distance(at, centre));
	}
	out->radius_m = nextafterf((float)radius, INFINITY);
}

/* Finds the farthest point of all spheres that the group's sphere must enclose. Returns its
 * distance. */
static double farthest(double out[3], const struct group_job *job, const double centre[3])
{
	double most = -1.0;

	for (uint32_t p = 0; p < job->patch_count; p++) {
		const struct live_patch *patch = &job->patches[p];
		const struct hierarchy_patch *made = &job->made[p];
		struct sphere spheres[2] = {
			{ { made->centre_m[0], made->centre_m[1], made->centre_m[2] },
			  made->radius_m },
			patch->finer_sphere,
		};

		for (int s = 0; s < (patch->finer == NO_GROUP ? 1 : 2); s++) {
			double away = distance(spheres[s].centre, centre);
			double reach = away + spheres[s].radius;

			if (reach <= most)
				continue;
			most = reach;
			for (int i = 0; i < 3; i++)
				out[i] = away > 0.0
						 ? centre[i] + (spheres[s].centre[i] - centre[i]) *
								       reach / away
						 : centre[i];
		}
	}
	return most;
}

/* Finds nearly the smallest sphere, by steps towards the farthest point (Badoiu and Clarkson 2003).
 * Spheres nest over many levels, so slack would add up. Each is measured from the centre that is
 * stored, rounded: far from the origin that is another place (see the Makefile). */
static void bound_group(struct group_job *job)
{
	double centre[3] = { job->made[0].centre_m[0], job->made[0].centre_m[1],
			     job->made[0].centre_m[2] };
	double best = INFINITY, reach, far[3], rounded[3];

	for (int step = 1; step <= 100; step++) {
		for (int i = 0; i < 3; i++)
			rounded[i] = (float)centre[i];
		reach = farthest(far, job, rounded);
		if (reach < best) {
			best = reach;
			for (int i = 0; i < 3; i++)
				job->group.centre_m[i] = (float)centre[i];
		}
		for (int i = 0; i < 3; i++)
			centre[i] += (far[i] - centre[i]) / (step + 1);
	}
	/* Slightly larger, so that nested spheres stay nested in single precision. */
	job->group.radius_m = (float)(best * (1.0 + 1e-6));
}

int group_job_write(const struct job_site *site, struct group_job *job, uint32_t *local_of)
{
	struct patch_mesh *meshes = calloc(job->patch_count, sizeof(*meshes));
	int rc = meshes ? 0 : -ENOMEM;

	job->made = calloc(job->patch_count, sizeof(*job->made));
	if (!job->made)
		rc = -ENOMEM;
	for (uint32_t p = 0; rc == 0 && p < job->patch_count; p++) {
		struct hierarchy_patch *made = &job->made[p];

		rc = fill_mesh(&meshes[p], site->mesh, &job->patches[p], local_of);
		if (rc < 0)
			break;
		made->finer = job->patches[p].finer;
		made->triangle_count = (uint16_t)meshes[p].triangle_count;
		made->vertex_count = (uint16_t)meshes[p].vertex_count;
		job->vertex_count += meshes[p].vertex_count;
		bound_patch(made, &meshes[p], &site->mesh->lattice);
		normal_cone_bound(made, &meshes[p]);
	}
	buffer_init(&job->object, OBJECT_BYTES_MAX);
	if (rc == 0) {
		bound_group(job);
		rc = patch_group_encode(&job->object, meshes, job->patch_count);
	}
	for (uint32_t p = 0; meshes && p < job->patch_count; p++)
		patch_mesh_finish(&meshes[p]);
	free(meshes);
	return rc;
}
