/* The three tools that select a part in a view, drawn by a scripted hand on parts of a scan of
 * which the truth is known (the paper's Figs. 12 and 13).
 *
 *   bench_regions SCAN z|y PICTURES < parts
 *
 * z, y: which axis of the scan is up. parts: a line for each,
 *
 *   NAME faces FILE                      the part's faces, as the temple's generator lists them
 *   NAME outline EYE TARGET FOV X Y ...  an outline in the view (3 + 3 + 1 numbers) of 1280 x 720,
 *                                        drawn once by a person; without points: only the picture
 *
 * PICTURES: a folder for what was drawn and found. Writes JSON: for each part, tool and seed the
 * time, by the length of strokes at a hand's speed and the computation, and the error: faces wrong,
 * per face of the part that the view shows.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "curator/select/face_pick.h"
#include "curator/select/part_cut.h"
#include "curator/view/view_draw.h"
#include "format/picture.h"
#include "geometry/vec.h"
#include "pipeline/import/face_list.h"
#include "pipeline/import/import.h"
#include "pipeline/samples/chunks.h"
#include "tests/bench/hand.h"

enum { WIDTH = HAND_WIDTH, HEIGHT = HAND_HEIGHT, PIXELS = HAND_PIXELS, SEEDS = 5 };
enum tool { TOOL_LASSO, TOOL_MARKUP, TOOL_HEAVY, TOOLS };
static const char *const tool_names[TOOLS] = { "lasso", "mark-up", "heavy lasso" };

/* What the hand has to stay within. */
static const float lasso_width_px = 6, heavy_width_px = 28, markup_width_px = 14;

/* The line of the part that is being read. */
static char *words;

struct world {
	struct mesh mesh;
	struct face_blocks blocks;
	struct model *model;
	struct view_draw *draw;
	uint8_t *shown; /* of each triangle of the mesh: 1 the view shows it, 2 it is of the part, 4
			   found */
	char *folder;
};

struct view {
	struct camera camera;
	struct view_image image;
	struct superpixels superpixels;
	uint8_t *truth; /* of each pixel: of the part */
	double superpixels_ms;
	uint32_t part_faces;
};

/* Processor time of this thread, which does all the work: other work on the machine does not count.
 */
static double spent_ms(void)
{
	struct timespec now;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

static void must(int rc, const char *doing)
{
	if (rc >= 0)
		return;
	fprintf(stderr, "%s: %s\n", doing, strerror(-rc));
	exit(1);
}

/* ---- the view of a part */

static void set_shown(void *user, uint32_t triangle)
{
	struct world *world = user;

	world->shown[triangle] |= 1;
}

static void set_found(void *user, uint32_t triangle)
{
	struct world *world = user;

	world->shown[triangle] |= 4;
}

static struct camera look_at(const struct mesh *mesh, const uint32_t *triangles, uint32_t count)
{
	float low[3] = { INFINITY, INFINITY, INFINITY },
	      high[3] = { -INFINITY, -INFINITY, -INFINITY };
	float face[3] = { 0 }, middle[3], area = 0;
	struct camera camera = { .up = { 0, 0, 1 },
				 .fov_deg = 40,
				 .near_m = 0.05f,
				 .far_m = 500,
				 .width_px = WIDTH,
				 .height_px = HEIGHT };

	for (uint32_t n = 0; n < count; n++) {
		const uint32_t *t = mesh->triangles[triangles[n]];
		float ab[3], ac[3], normal[3];

		for (int k = 0; k < 3; k++)
			for (int i = 0; i < 3; i++) {
				low[i] = vec_least(low[i], mesh->positions[t[k]][i]);
				high[i] = vec_most(high[i], mesh->positions[t[k]][i]);
			}
		vec_sub(ab, mesh->positions[t[1]], mesh->positions[t[0]]);
		vec_sub(ac, mesh->positions[t[2]], mesh->positions[t[0]]);
		vec_cross(normal, ab, ac);
		vec_add(face, face, normal);
		area += vec_length(normal);
	}
	vec_mix(middle, low, high, 0.5f);
	/* From where it faces, or else from outside; a little from the side and from above. */
	face[2] = 0;
	if (vec_length(face) < 0.2f * area)
		vec_copy(face, middle);
	face[2] = 0;
	vec_normalise(face);
	const float aside[3] = { -face[1], face[0], 0 };
	vec_add_scaled(face, face, 0.35f, aside);
	face[2] = 0.25f;
	vec_normalise(face);
	const float size = vec_distance(low, high);
	vec_copy(camera.target_m, middle);
	vec_add_scaled(camera.eye_m, middle,
		       1.25f * size / (2 * tanf(20 * (float)M_PI / 180)) * 1.25f, face);
	return camera;
}

/* The pixels of the part: it is painted in a colour that nothing else has. */
static void find_truth(struct world *world, struct view *view, const uint32_t *triangles,
		       uint32_t count)
{
	struct mesh painted = world->mesh;
	struct view_image image;
	struct view_draw *draw;
	struct model *model;

	painted.colours = malloc((size_t)painted.vertex_count * sizeof(*painted.colours));
	memset(painted.colours, 0, (size_t)painted.vertex_count * sizeof(*painted.colours));
	for (uint32_t n = 0; n < count; n++)
		for (int k = 0; k < 3; k++)
			memset(painted.colours[painted.triangles[triangles[n]][k]], 255, 4);
	must(chunks_create(&model, &painted, (const uint8_t[3]){ 0 }), "paint the part");
	must(view_draw_create(&draw, model, WIDTH, HEIGHT), "picture");
	must(view_draw_image(draw, &view->camera, 0, &image), "draw the part");
	for (uint32_t at = 0; at < PIXELS; at++)
		view->truth[at] = image.colours[at][0] > 127;
	view_draw_destroy(draw);
	model_destroy(model);
	free(painted.colours);
}

/* Draws the view, and finds which faces it shows. */
static void open_view(struct world *world, struct view *view)
{
	struct face_view all = { .camera = &view->camera, .image = &view->image };
	uint8_t *whole = malloc(PIXELS);

	must(view_draw_image(world->draw, &view->camera, 0, &view->image), "draw");
	const double began = spent_ms();
	must(superpixels_make(&view->superpixels, &view->image), "superpixels");
	view->superpixels_ms = spent_ms() - began;
	memset(world->shown, 0, world->mesh.triangle_count);
	memset(whole, 1, PIXELS);
	all.in_part = whole;
	face_pick(&all, &world->mesh, &world->blocks, set_shown, world);
	free(whole);
}

/* A part whose faces are known: its own view, and its pixels there. */
static bool open_faces(struct world *world, struct view *view, const char *path)
{
	struct diagnostics diagnostics = { 0 };
	struct face_list list;
	uint32_t *triangles, count;

	if (face_list_read(&list, path, path, world->mesh.scans[0].face_count, &diagnostics) < 0)
		return false;
	must(face_list_triangles(&triangles, &count, &list, &world->mesh, 0), "faces");
	view->camera = look_at(&world->mesh, triangles, count);
	find_truth(world, view, triangles, count);
	open_view(world, view);
	for (uint32_t n = 0; n < count; n++)
		world->shown[triangles[n]] |= 2;
	free(triangles);
	face_list_finish(&list);
	return true;
}

static bool read_number(float *out)
{
	const char *word = strtok_r(NULL, " \t\n", &words);

	if (word)
		*out = strtof(word, NULL);
	return word != NULL;
}

static void set_part(void *user, uint32_t triangle)
{
	struct world *world = user;

	world->shown[triangle] |= 2;
}

/* A part that a person has gone around. Returns false if there is only a view. */
static bool open_outline(struct world *world, struct view *view)
{
	struct hand_path path = { malloc(HAND_POINTS_MAX * sizeof(*path.points)), 0 };
	struct face_view part = { .camera = &view->camera,
				  .image = &view->image,
				  .in_part = view->truth };
	float x, y;

	view->camera = (struct camera){ .up = { 0, 0, 1 },
					.near_m = 0.001f,
					.far_m = 1000,
					.width_px = WIDTH,
					.height_px = HEIGHT };
	for (int i = 0; i < 3; i++)
		read_number(&view->camera.eye_m[i]);
	for (int i = 0; i < 3; i++)
		read_number(&view->camera.target_m[i]);
	read_number(&view->camera.fov_deg);
	while (read_number(&x) && read_number(&y))
		hand_add_point(&path, x, y);
	open_view(world, view);
	const struct stroke stroke = { (const float(*)[2])path.points, path.count, 1 };
	const bool any = path.count > 2 && strokes_lasso(view->truth, WIDTH, HEIGHT, &stroke) == 0;
	for (uint32_t at = 0; at < PIXELS; at++)
		view->truth[at] =
			any && view->truth[at] == MARK_PART && view->image.inverse_m[at] > 0;
	face_pick(&part, &world->mesh, &world->blocks, set_part, world);
	free(path.points);
	return any;
}

/* ---- the tools */

struct outcome {
	float hand_s;
	double compute_ms, longest_ms;
	uint32_t strokes, wrong_faces;
	double first_error; /* after the first stroke, or set of strokes */
};

static double error_of(struct world *world, const struct view *view, const uint8_t *in_part)
{
	const struct face_view part = { .camera = &view->camera,
					.image = &view->image,
					.in_part = in_part };
	uint32_t wrong = 0;

	for (uint32_t t = 0; t < world->mesh.triangle_count; t++)
		world->shown[t] &= 3;
	face_pick(&part, &world->mesh, &world->blocks, set_found, world);
	for (uint32_t t = 0; t < world->mesh.triangle_count; t++)
		wrong += (world->shown[t] & 1) &&
			 ((world->shown[t] & 2) != 0) != ((world->shown[t] & 4) != 0);
	return (double)wrong / view->part_faces;
}

static void compute(struct outcome *outcome, uint8_t *in_part, const uint8_t *marks,
		    const struct view *view)
{
	const double began = spent_ms();
	const int rc = part_cut(in_part, marks, &view->image, &view->superpixels);
	const double ms = spent_ms() - began;

	must(rc, "cut");
	outcome->compute_ms += ms;
	outcome->longest_ms = ms > outcome->longest_ms ? ms : outcome->longest_ms;
}

/* The largest piece that is on the wrong side; returns whether it is of the part. */
static bool find_wrong(uint8_t *out, uint32_t *pixels, const uint8_t *in_part,
		       const struct view *view)
{
	uint8_t *wrong = malloc(PIXELS);

	for (uint32_t at = 0; at < PIXELS; at++)
		wrong[at] = view->image.inverse_m[at] > 0 && in_part[at] != view->truth[at];
	*pixels = hand_largest_piece(out, wrong);
	bool part = false;
	for (uint32_t at = 0; at < PIXELS; at++)
		if (out[at])
			part = view->truth[at];
	free(wrong);
	return part;
}

/* Strokes over what is wrong, until it is within two percent or six strokes are drawn. With the
 * lasso a wrong piece is gone around, otherwise it is marked through its middle. */
static double correct(struct outcome *outcome, enum tool tool, uint8_t *marks, uint8_t *in_part,
		      struct world *world, const struct view *view, struct hand_path *path)
{
	uint8_t *piece = malloc(PIXELS), *fill = malloc(PIXELS);
	double error = error_of(world, view, in_part);

	outcome->first_error = error;
	for (int n = 0; n < 6 && error > 0.02; n++) {
		uint32_t pixels;
		const bool part = find_wrong(piece, &pixels, in_part, view);

		if (pixels < 40)
			break;
		outcome->strokes++;
		if (tool == TOOL_LASSO) {
			hand_trace(path, piece);
			outcome->hand_s += hand_draw(path, true, lasso_width_px);
			const struct stroke stroke = { (const float(*)[2])path->points, path->count,
						       1 };
			if (strokes_lasso(fill, WIDTH, HEIGHT, &stroke) == 0)
				for (uint32_t at = 0; at < PIXELS; at++)
					if (fill[at] == MARK_PART)
						in_part[at] = part;
		} else {
			hand_through_middle(path, piece);
			outcome->hand_s += hand_draw(path, false, markup_width_px);
			const struct stroke stroke = { (const float(*)[2])path->points, path->count,
						       3 };
			strokes_paint(marks, WIDTH, HEIGHT, &stroke,
				      part ? MARK_PART_SEED : MARK_REST_SEED);
			compute(outcome, in_part, marks, view);
		}
		error = error_of(world, view, in_part);
	}
	free(piece);
	free(fill);
	return error;
}

static void keep_picture(const struct world *world, const struct view *view, const uint8_t *in_part,
			 const uint8_t *marks, const char *name)
{
	uint8_t *rgba = malloc(4 * PIXELS);
	const struct picture picture = { WIDTH, HEIGHT, rgba };
	struct buffer file;
	char path[512];

	for (uint32_t at = 0; at < PIXELS; at++) {
		const float light =
			0.35f + 0.65f *
					fabsf((float)view->image.normals[at][0] * 0.5f +
					      (float)view->image.normals[at][1] * 0.3f +
					      (float)view->image.normals[at][2] * 0.8f) /
					127;
		for (int i = 0; i < 3; i++) {
			float value =
				view->image.inverse_m[at] > 0
					? vec_least(255, light * (float)view->image.colours[at][i])
					: 235;
			if (in_part[at])
				value = value * 0.6f + (i == 2 ? 0 : 255) * 0.4f;
			if (marks && marks[at] == MARK_PART_SEED)
				value = i == 2 ? 0 : 255;
			if (marks && marks[at] == MARK_REST_SEED)
				value = i == 2 ? 255 : 40;
			rgba[4 * at + i] = (uint8_t)value;
		}
		rgba[4 * at + 3] = 255;
	}
	buffer_init(&file, 64 << 20);
	must(picture_encode_png(&file, &picture), "encode");
	snprintf(path, sizeof(path), "%s/%s.png", world->folder, name);
	must(bytes_write_file(buffer_bytes(&file), path), path);
	buffer_finish(&file);
	free(rgba);
}

/* Three strokes for the part (along both axes of what is seen of it) and four beside it. */
static void mark_up(struct outcome *outcome, uint8_t *marks, const struct view *view,
		    struct hand_path *path)
{
	uint8_t *piece = malloc(PIXELS), *around = malloc(PIXELS);
	struct hand_path outside = { malloc(HAND_POINTS_MAX * sizeof(*outside.points)), 0 };

	hand_largest_piece(piece, view->truth);
	memset(marks, MARK_UNKNOWN, PIXELS);
	hand_through_middle(path, piece);
	outcome->hand_s += hand_draw(path, false, markup_width_px);
	const struct stroke inside = { (const float(*)[2])path->points, path->count, 3 };
	strokes_paint(marks, WIDTH, HEIGHT, &inside, MARK_PART_SEED);
	/* beside it: along a border twelve pixels away, every other quarter of it */
	hand_trace(path, piece);
	memset(around, 0, PIXELS);
	const struct stroke wide = { (const float(*)[2])path->points, path->count, 40 };
	strokes_paint(around, WIDTH, HEIGHT, &wide, 1);
	for (uint32_t at = 0; at < PIXELS; at++)
		around[at] = around[at] || piece[at];
	hand_trace(&outside, around);
	for (uint32_t quarter = 0; quarter < 4; quarter++) {
		const uint32_t from = outside.count * (2 * quarter) / 8,
			       end = outside.count * (2 * quarter + 1) / 8;

		path->count = 0;
		for (uint32_t i = from; i < end; i++)
			hand_add_point(path, outside.points[i][0], outside.points[i][1]);
		if (path->count < 8)
			continue;
		outcome->hand_s += hand_draw(path, false, markup_width_px);
		const struct stroke stroke = { (const float(*)[2])path->points, path->count, 3 };
		strokes_paint(marks, WIDTH, HEIGHT, &stroke, MARK_REST_SEED);
	}
	outcome->strokes = 5;
	free(outside.points);
	free(piece);
	free(around);
}

static double use_tool(struct outcome *outcome, enum tool tool, struct world *world,
		       const struct view *view, const char *picture)
{
	struct hand_path path = { malloc(HAND_POINTS_MAX * sizeof(*path.points)), 0 };
	uint8_t *marks = malloc(PIXELS), *in_part = malloc(PIXELS), *piece = malloc(PIXELS);
	double error;

	memset(outcome, 0, sizeof(*outcome));
	if (tool == TOOL_MARKUP) {
		mark_up(outcome, marks, view, &path);
	} else {
		hand_largest_piece(piece, view->truth);
		hand_trace(&path, piece);
		outcome->strokes = 1;
		outcome->hand_s = hand_draw(&path, true,
					    tool == TOOL_LASSO ? lasso_width_px : heavy_width_px);
		const struct stroke stroke = { (const float(*)[2])path.points, path.count,
					       heavy_width_px * 1.4f };
		must(tool == TOOL_LASSO ? strokes_lasso(marks, WIDTH, HEIGHT, &stroke)
					: strokes_heavy_lasso(marks, WIDTH, HEIGHT, &stroke),
		     "stroke");
	}
	if (tool == TOOL_LASSO)
		for (uint32_t at = 0; at < PIXELS; at++)
			in_part[at] = marks[at] == MARK_PART && view->image.inverse_m[at] > 0;
	else
		compute(outcome, in_part, marks, view);
	if (picture)
		keep_picture(world, view, in_part, marks, picture);
	error = correct(outcome, tool, marks, in_part, world, view, &path);
	free(path.points);
	free(marks);
	free(in_part);
	free(piece);
	return error;
}

static void do_tools(struct world *world, const struct view *view, const char *name)
{
	for (int tool = 0; tool < TOOLS; tool++) {
		printf("%s\n    {\"tool\": \"%s\", \"runs\": [", tool > 0 ? "," : "",
		       tool_names[tool]);
		for (uint32_t seed = 0; seed < SEEDS; seed++) {
			struct outcome outcome;
			char picture[256];

			snprintf(picture, sizeof(picture), "%s-%s", name, tool_names[tool]);
			hand_seed(seed * 7919 + 17);
			const double error = use_tool(&outcome, (enum tool)tool, world, view,
						      seed == 0 ? picture : NULL);
			printf("%s{\"hand_s\": %.2f, \"compute_ms\": %.1f, \"longest_ms\": %.1f, "
			       "\"strokes\": %u, \"first_error\": %.4f, \"error\": %.4f}",
			       seed ? ", " : "", (double)outcome.hand_s, outcome.compute_ms,
			       outcome.longest_ms, outcome.strokes, outcome.first_error, error);
		}
		printf("]}");
	}
}

static void do_part(struct world *world, char *line, bool first)
{
	const char *name = strtok_r(line, " \t\n", &words), *kind = strtok_r(NULL, " \t\n", &words);
	struct view view = { .truth = malloc(PIXELS) };
	bool known = false;

	if (kind && strcmp(kind, "faces") == 0)
		known = open_faces(world, &view, strtok_r(NULL, " \t\n", &words));
	else if (kind && strcmp(kind, "outline") == 0)
		known = open_outline(world, &view);
	for (uint32_t t = 0; t < world->mesh.triangle_count; t++)
		view.part_faces += world->shown[t] == 3;
	if (view.image.width_px)
		keep_picture(world, &view, view.truth, NULL, name);
	if (known && view.part_faces > 0) {
		printf("%s\n  {\"part\": \"%s\", \"shown\": %u, \"superpixels\": %u, "
		       "\"superpixels_ms\": %.1f, \"tools\": [",
		       first ? "" : ",", name, view.part_faces, view.superpixels.count,
		       view.superpixels_ms);
		do_tools(world, &view, name);
		printf("]}");
		fflush(stdout);
	} else {
		fprintf(stderr, "%s: nothing of it is to be seen\n", name);
	}
	superpixels_finish(&view.superpixels);
	free(view.truth);
}

int main(int argc, char **argv)
{
	struct import_options options = { 0 };
	struct diagnostics diagnostics = { 0 };
	struct world world = { 0 };
	bool first = true;
	char line[4096];

	if (argc != 4) {
		fprintf(stderr, "usage: bench_regions SCAN z|y PICTURES < parts\n");
		return 2;
	}
	options.up = argv[2][0] == 'y' ? IMPORT_Y_UP : IMPORT_Z_UP;
	world.folder = argv[3];
	mkdir(world.folder, 0777);
	must(import_scan(&world.mesh, argv[1], &options, NULL, &diagnostics), argv[1]);
	must(face_blocks_make(&world.blocks, &world.mesh), "blocks");
	must(chunks_create(&world.model, &world.mesh, (const uint8_t[3]){ 180, 170, 150 }),
	     "chunks");
	must(view_draw_create(&world.draw, world.model, WIDTH, HEIGHT), "picture");
	world.shown = calloc(world.mesh.triangle_count, 1);
	printf("{\"rows\": [");
	while (fgets(line, sizeof(line), stdin)) {
		do_part(&world, line, first);
		first = false;
	}
	printf("\n]}\n");
	free(world.shown);
	view_draw_destroy(world.draw);
	model_destroy(world.model);
	face_blocks_finish(&world.blocks);
	mesh_finish(&world.mesh);
	return 0;
}
