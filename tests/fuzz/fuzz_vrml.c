/* A VRML97 scene, gzip'd or not, which may name itself as the file of an Inline or a prototype: it
 * is refused with its name, or becomes triangles whose numbers are finite or far, and whose
 * textures are there; or scenery; or views, whose times ascend. Beside it are a grey picture, a
 * coloured one and one that is damaged, and a wooden look is known for "Wood". */
#include <errno.h>

#include "pipeline/scene/vrml_scenery.h"
#include "pipeline/scene/vrml_surface.h"
#include "pipeline/scene/vrml_views.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/small_png.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int open_beside(void *data, const char *name)
{
	static const char *const names[] = { "other.wrl", "grey.png", "coloured.png",
					     "damaged.png" };

	(void)data;
	for (size_t i = 0; i < ARRAY_COUNT(names); i++)
		if (strcmp(name, names[i]) == 0)
			return open(scratch_path(name), O_RDONLY | O_CLOEXEC);
	return -ENOENT;
}

static void check(const struct vrml_surface *surface)
{
	for (uint32_t i = 0; i < surface->soup.count; i++) {
		uint32_t texture = surface->soup.triangles[i].texture;

		if (texture != SOUP_NO_TEXTURE && texture >= surface->texture_count)
			abort();
	}
}

static int make_scenery(const struct vrml *scene, const struct vrml_options *options,
			struct diagnostics *diagnostics, struct diagnostics *warnings)
{
	const struct scenery_node root = { .parent = SCENERY_NONE,
					   .layer = SCENERY_NONE,
					   .place = scenery_at_rest };
	struct scenery_look wood = { .name = "Wood",
				     .substance = SUBSTANCE_WOOD,
				     .relief_m = 0.01f };
	struct scenery_maker maker = { .looks = &wood, .look_count = 1 };
	struct scenery made = { 0 };
	uint32_t node = 0;
	int rc = scenery_add_node(&maker, &root, &node);

	if (rc == 0)
		rc = vrml_scenery_add(&maker, scene, node, options, diagnostics, warnings);
	if (rc == 0 && scenery_maker_end(&maker, &made) == 0)
		(void)scenery_is_sane(&made); /* numbers may be too large */
	scenery_maker_finish(&maker);
	scenery_finish(&made);
	return rc;
}

/* description: of the view that is wanted; NULL: the only one. */
static void read_views(const struct vrml *scene, const char *description)
{
	struct diagnostics diagnostics = { 0 };
	struct scene_views views;
	int rc = vrml_views_read(&views, scene, description, &diagnostics);

	if (rc < 0 && diagnostics.error_count == 0)
		abort();
	for (uint32_t i = 1; i < views.count; i++)
		if (views.items[i].time_s < views.items[i - 1].time_s)
			abort();
	scene_views_finish(&views);
}

static void begin(void)
{
	if (scratch[0])
		return;
	scratch_begin();
	scratch_write("grey.png", small_png, sizeof(small_png));
	scratch_write("coloured.png", coloured_png, sizeof(coloured_png));
	scratch_write("damaged.png", small_png, sizeof(small_png) - 20);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct vrml_options options = { .open_file = open_beside };
	struct vrml_surface surface;
	struct vrml *scene;
	int rc;

	begin();
	scratch_write("other.wrl", data, size);
	rc = vrml_read(&scene, (struct bytes){ data, size }, "a.wrl", &options, &diagnostics,
		       &warnings);
	if (rc == 0) {
		read_views(scene, NULL);
		read_views(scene, "w");
		rc = vrml_surface_make(&surface, scene, &diagnostics);
		if (rc == 0) {
			check(&surface);
			vrml_surface_finish(&surface);
			rc = make_scenery(scene, &options, &diagnostics, &warnings);
		}
	}
	if (rc < 0 && !strstr(diagnostics.first.text, ".wrl"))
		abort();
	vrml_destroy(scene);
	return 0;
}
