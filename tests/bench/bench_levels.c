/* How far each level of a hierarchy lies from its scan: bench_levels MESH MASTER, the mesh file and
 * the folder of the master below a content folder's .work. A level is the cut with at least a half,
 * a quarter, an eighth ... of the scan's triangles, refined by falling error. Beside each,
 * meshoptimizer's simplification of the whole scan to as many triangles. The same for the finest
 * that a release shows (a tenth, all levels counted), as it is in the master and as it is
 * published, with rounded positions. Points are spread over one surface by area, and the nearest
 * point of the other is found, both ways. JSON to standard output; lengths in millimetres. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/patch.h"
#include "pipeline/hierarchy/master_cut.h"
#include "pipeline/import/mesh_file.h"
#include "pipeline/release/publish_hierarchy.h"
#include "tests/bench/surface_error.h"

enum { HALVINGS = 9 };

static const double published_share = 0.1;

/* ---- ours */

/* A cut that is refined group by group. */
struct cut {
	const struct master *master;
	bool *refined;   /* for each group */
	uint32_t *order; /* groups by falling error */
	uint32_t next;   /* in the order */
	int64_t triangle_count;
};

static const struct hierarchy *sorted_hierarchy;

static int compare_errors(const void *left, const void *right)
{
	uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
	float ea = sorted_hierarchy->groups[a].error_m, eb = sorted_hierarchy->groups[b].error_m;

	if (ea != eb)
		return ea > eb ? -1 : 1;
	return a < b ? -1 : a > b;
}

static void cut_init(struct cut *cut, const struct master *master)
{
	uint32_t count = master->hierarchy.group_count;

	*cut = (struct cut){ .master = master,
			     .refined = need(calloc(count, sizeof(bool))),
			     .order = need(malloc(count * sizeof(uint32_t))) };
	for (uint32_t g = 0; g < count; g++)
		cut->order[g] = g;
	sorted_hierarchy = &master->hierarchy;
	qsort(cut->order, count, sizeof(*cut->order), compare_errors);
}

/* Refines until the cut has that many triangles, or is the finest. */
static void cut_refine(struct cut *cut, int64_t least, const int64_t *gains)
{
	while (cut->next < cut->master->hierarchy.group_count && cut->triangle_count < least) {
		uint32_t group = cut->order[cut->next++];

		cut->refined[group] = true;
		cut->triangle_count += gains[group];
	}
}

/* For each group, by how many triangles a cut grows that refines it. */
static int64_t *find_gains(const struct hierarchy *hierarchy)
{
	int64_t *gains = need(calloc(hierarchy->group_count, sizeof(*gains)));

	for (uint32_t p = 0; p < hierarchy->patch_count; p++) {
		const struct hierarchy_patch *patch = &hierarchy->patches[p];

		gains[patch->group] += patch->triangle_count;
		if (patch->finer != HIERARCHY_NONE)
			gains[patch->finer] -= patch->triangle_count;
	}
	return gains;
}

static void add_patch(struct surface *surface, const struct lattice *lattice,
		      const struct patch_mesh *patch)
{
	for (uint32_t i = 0; i < 3 * patch->triangle_count; i++) {
		double at[3];
		uint32_t vertex = 3 * surface->triangle_count + i;

		lattice_metres(at, lattice, patch->vertices[patch->indices[i]].position);
		for (int k = 0; k < 3; k++)
			surface->positions[vertex][k] = (float)at[k];
		surface->triangles[vertex / 3][i % 3] = vertex;
	}
	surface->triangle_count += patch->triangle_count;
}

static struct surface surface_of(int64_t triangle_count)
{
	size_t triangles = (size_t)triangle_count;

	return (struct surface){ .positions = need(malloc(triangles * sizeof(float[3][3]))),
				 .triangles = need(malloc(triangles * sizeof(uint32_t[3]))) };
}

/* Adds those patches of a group that nothing refines. refined: for each group; NULL: all are. */
static void add_group(struct surface *surface, const struct lattice *lattice,
		      const struct hierarchy *hierarchy, uint32_t group, const bool *refined,
		      struct bytes object)
{
	struct patch_mesh patches[GROUP_PATCHES_MAX];
	uint32_t count;

	need_ok(patch_group_decode(patches, &count, object), "patches");
	for (uint32_t i = 0; i < count; i++) {
		uint32_t finer = hierarchy->patches[hierarchy->groups[group].first_patch + i].finer;

		if (finer == HIERARCHY_NONE || (refined && !refined[finer]))
			add_patch(surface, lattice, &patches[i]);
		patch_mesh_finish(&patches[i]);
	}
}

static struct surface cut_surface(const struct cut *cut)
{
	const struct master *master = cut->master;
	struct surface surface = surface_of(cut->triangle_count);
	struct buffer object;

	buffer_init(&object, OBJECT_BYTES_MAX);
	for (uint32_t g = 0; g < master->hierarchy.group_count; g++) {
		if (!cut->refined[g])
			continue;
		buffer_clear(&object);
		need_ok(master_read_group(master, g, &object), "master");
		add_group(&surface, &master->lattice, &master->hierarchy, g, cut->refined,
			  buffer_bytes(&object));
	}
	buffer_finish(&object);
	return surface;
}

/* The finest that is published: as the master has it, and as the release has it. */
static void published_surfaces(struct surface *whole, struct surface *rounded,
			       const struct master *master)
{
	struct published_patches published;
	struct object_store *store;
	struct page_child child;
	struct master_cut cut;
	struct buffer object;
	struct page page;

	need_ok(master_cut_create(&cut, master, published_share), "cut");
	need_ok(object_store_create(&store), "objects");
	need_ok(publish_hierarchy(store, master, published_share, &child, &published), "publish");
	*whole = surface_of((int64_t)published.triangle_count);
	*rounded = surface_of((int64_t)published.triangle_count);
	buffer_init(&object, OBJECT_BYTES_MAX);
	need_ok(object_store_read(store, child.hash, &object), "page");
	need_ok(page_decode(&page, buffer_bytes(&object)), "page");
	for (uint32_t g = 0; g < page.child_count; g++) {
		struct buffer group;

		buffer_init(&group, OBJECT_BYTES_MAX);
		need_ok(master_read_group(master, cut.groups[g], &group), "master");
		add_group(whole, &master->lattice, &cut.hierarchy, g, NULL, buffer_bytes(&group));
		buffer_clear(&group);
		need_ok(object_store_read(store, page.children[g].hash, &group), "group");
		add_group(rounded, &master->lattice, &cut.hierarchy, g, NULL, buffer_bytes(&group));
		buffer_finish(&group);
	}
	page_finish(&page);
	buffer_finish(&object);
	object_store_destroy(store);
	master_cut_finish(&cut);
}

/* ---- the peer */

/* Corners at one place share a number, as the simplifier wants it: it leaves seams alone. */
static uint32_t *weld(const struct mesh *mesh)
{
	size_t corners = 3 * (size_t)mesh->triangle_count;
	uint32_t *indices = need(malloc(corners * sizeof(*indices)));

	meshopt_generateShadowIndexBuffer(indices, mesh->triangles[0], corners, mesh->positions,
					  mesh->vertex_count, sizeof(*mesh->positions),
					  sizeof(*mesh->positions));
	return indices;
}

static struct surface simplified(const struct mesh *mesh, const uint32_t *welded,
				 uint32_t triangles)
{
	size_t corners = 3 * (size_t)mesh->triangle_count;
	uint32_t *indices = need(malloc(corners * sizeof(*indices)));
	size_t left =
		meshopt_simplify(indices, welded, corners, mesh->positions[0], mesh->vertex_count,
				 sizeof(*mesh->positions), 3 * (size_t)triangles, 1e9f, 0, NULL);

	return (struct surface){ .positions = mesh->positions,
				 .triangles = (uint32_t(*)[3])(void *)indices,
				 .triangle_count = (uint32_t)(left / 3) };
}

/* ---- the whole */

static void print_level(struct cut *cut, const struct surface *scan, const struct mesh *mesh,
			const uint32_t *welded)
{
	struct surface ours = cut_surface(cut);
	struct surface theirs = simplified(mesh, welded, ours.triangle_count);

	fputs("  {", stdout);
	print_errors("ours", &ours, scan);
	fputs(", ", stdout);
	print_errors("meshoptimizer", &theirs, scan);
	fputs("}", stdout);
	free(ours.positions);
	free(ours.triangles);
	free(theirs.triangles);
}

static void print_published(const struct master *master, const struct surface *scan,
			    const struct mesh *mesh, const uint32_t *welded)
{
	struct surface whole, rounded, theirs;

	published_surfaces(&whole, &rounded, master);
	theirs = simplified(mesh, welded, whole.triangle_count);
	print_errors("whole", &whole, scan);
	fputs(", ", stdout);
	print_errors("rounded", &rounded, scan);
	fputs(", ", stdout);
	print_errors("meshoptimizer", &theirs, scan);
	free(whole.positions);
	free(whole.triangles);
	free(rounded.positions);
	free(rounded.triangles);
	free(theirs.triangles);
}

static struct hash key_of_file(const char *path)
{
	struct hash key;
	FILE *file = fopen(path, "rb");

	if (!file || fseek(file, 12, SEEK_SET) < 0 || fread(&key, sizeof(key), 1, file) != 1)
		need_ok(-ENOENT, path);
	fclose(file);
	return key;
}

int main(int argc, char **argv)
{
	struct mesh mesh;
	struct master *master;
	struct surface scan;
	struct cut cut;
	uint32_t *welded;
	int64_t *gains;

	if (argc != 3) {
		fputs("usage: bench_levels DIR/.work/mesh DIR/.work/master\n", stderr);
		return 2;
	}
	need_ok(mesh_file_load(&mesh, key_of_file(argv[1]), argv[1]), argv[1]);
	need_ok(master_open(&master, argv[2], NULL), argv[2]);
	scan = (struct surface){ mesh.positions, mesh.triangles, mesh.triangle_count, NULL };
	surface_index(&scan);
	welded = weld(&mesh);
	gains = find_gains(&master->hierarchy);
	cut_init(&cut, master);
	printf("{\"triangles\": %u, \"levels\": [", mesh.triangle_count);
	for (int halving = HALVINGS; halving > 0; halving--) {
		uint32_t before = cut.next;

		cut_refine(&cut, mesh.triangle_count >> halving, gains);
		if (cut.next == before)
			continue; /* the cut of the row before has as many */
		puts(before > 0 ? "," : "");
		print_level(&cut, &scan, &mesh, welded);
	}
	fputs("],\n \"published\": {", stdout);
	print_published(master, &scan, &mesh, welded);
	puts("}}");
	free(gains);
	free(welded);
	free(cut.order);
	free(cut.refined);
	nearest_destroy(scan.nearest);
	master_destroy(master);
	mesh_finish(&mesh);
	return EXIT_SUCCESS;
}
