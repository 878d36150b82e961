/* The three tools that select a part in a view, drawn by a scripted hand on parts of the demo
 * temple whose true faces the generator knows (the paper's Figs. 12 and 13).
 *
 *   bench_regions TEMPLE.ply REGIONS PICTURES < parts
 *
 * parts: a line for each, NAME: REGIONS/NAME.faces. PICTURES: a folder for what was drawn and
 * found. Writes JSON: for each part, tool and seed the time, by the length of strokes at a hand's
 * speed and the computation, and the error: faces wrong, per face of the part that the view shows.
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

enum { WIDTH = 1280, HEIGHT = 720, PIXELS = WIDTH * HEIGHT, SEEDS = 5, POINTS_MAX = 20000 };
enum tool { TOOL_LASSO, TOOL_MARKUP, TOOL_HEAVY, TOOLS };
static const char *const tool_names[TOOLS] = { "lasso", "mark-up", "heavy lasso" };

/* The hand. Its speed along a path follows the steering law (Accot and Zhai 1997): the wider the
 * path that it has to stay on, the faster, seconds per length of a path's width. A stroke begins
 * after a moment. */
static const float steer_s = 0.1f, begin_s = 0.8f, fastest_px_s = 1000;
static const float lasso_width_px = 6, heavy_width_px = 28, markup_width_px = 14;

struct path {
	float (*points)[2];
	uint32_t count;
};

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

/* ---- chance: the same for a seed everywhere */

static uint64_t chance_state;

static double chance(void)
{
	chance_state = chance_state * 6364136223846793005u + 1442695040888963407u;
	return (double)(chance_state >> 11) / (double)(1ull << 53);
}

static double normal_chance(void)
{
	return sqrt(-2 * log(chance() + 1e-12)) * cos(2 * M_PI * chance());
}

/* ---- the view of a part */

static void set_bit(void *user, uint32_t triangle)
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
	struct model *model;

	painted.colours = malloc((size_t)painted.vertex_count * sizeof(*painted.colours));
	memset(painted.colours, 0, (size_t)painted.vertex_count * sizeof(*painted.colours));
	for (uint32_t n = 0; n < count; n++)
		for (int k = 0; k < 3; k++)
			memset(painted.colours[painted.triangles[triangles[n]][k]], 255, 4);
	must(chunks_create(&model, &painted, (const uint8_t[3]){ 0 }), "paint the part");
	must(view_draw_image(world->draw, model, &view->camera, 0, &image), "draw the part");
	for (uint32_t at = 0; at < PIXELS; at++)
		view->truth[at] = image.colours[at][0] > 127;
	model_destroy(model);
	free(painted.colours);
}

static void open_view(struct world *world, struct view *view, const uint32_t *triangles,
		      uint32_t count)
{
	struct face_view all = { .camera = &view->camera, .image = &view->image };
	uint8_t *whole = malloc(PIXELS);

	view->camera = look_at(&world->mesh, triangles, count);
	view->truth = malloc(PIXELS);
	find_truth(world, view, triangles, count);
	must(view_draw_image(world->draw, world->model, &view->camera, 0, &view->image), "draw");
	const double began = spent_ms();
	must(superpixels_make(&view->superpixels, &view->image), "superpixels");
	view->superpixels_ms = spent_ms() - began;
	memset(world->shown, 0, world->mesh.triangle_count);
	memset(whole, 1, PIXELS);
	all.in_part = whole;
	face_pick(&all, &world->mesh, &world->blocks, set_bit, world);
	view->part_faces = 0;
	for (uint32_t n = 0; n < count; n++) {
		world->shown[triangles[n]] |= 2;
		view->part_faces += world->shown[triangles[n]] & 1;
	}
	free(whole);
}

/* ---- paths */

static void add_point(struct path *path, float x, float y)
{
	if (path->count >= POINTS_MAX)
		return;
	path->points[path->count][0] = x;
	path->points[path->count++][1] = y;
}

/* The largest connected piece of a mask; returns its pixels. */
static uint32_t largest_piece(uint8_t *out, const uint8_t *mask)
{
	uint32_t *waiting = malloc(PIXELS * sizeof(*waiting)), best = 0, best_at = 0;
	uint8_t *seen = calloc(PIXELS, 1);

	for (int pass = 0; pass < 2; pass++) {
		if (pass == 1) {
			memset(seen, 0, PIXELS);
			memset(out, 0, PIXELS);
		}
		for (uint32_t from = pass ? best_at : 0; from < PIXELS; from++) {
			uint32_t count = 0, done = 0;

			if (!mask[from] || seen[from])
				continue;
			waiting[count++] = from;
			seen[from] = 1;
			while (done < count) {
				const uint32_t at = waiting[done++], x = at % WIDTH;
				const uint32_t to[4] = { x > 0 ? at - 1 : at,
							 x + 1 < WIDTH ? at + 1 : at,
							 at >= WIDTH ? at - WIDTH : at,
							 at + WIDTH < PIXELS ? at + WIDTH : at };

				if (pass == 1)
					out[at] = 1;
				for (int k = 0; k < 4; k++)
					if (mask[to[k]] && !seen[to[k]]) {
						seen[to[k]] = 1;
						waiting[count++] = to[k];
					}
			}
			if (count > best) {
				best = count;
				best_at = from;
			}
			if (pass == 1)
				break;
		}
	}
	free(waiting);
	free(seen);
	return best;
}

/* The outer border of a piece, clockwise (Moore's neighbours). */
static void trace(struct path *out, const uint8_t *mask)
{
	static const int dx[8] = { 1, 1, 0, -1, -1, -1, 0, 1 },
			 dy[8] = { 0, 1, 1, 1, 0, -1, -1, -1 };
	int x = 0, y = 0, from = 6;
	uint32_t start = 0;

	out->count = 0;
	while (start < PIXELS && !mask[start])
		start++;
	if (start == PIXELS)
		return;
	x = (int)(start % WIDTH);
	y = (int)(start / WIDTH);
	do {
		int k = 0;

		add_point(out, (float)x + 0.5f, (float)y + 0.5f);
		for (; k < 8; k++) {
			const int way = (from + k) % 8, tx = x + dx[way], ty = y + dy[way];

			if (tx >= 0 && ty >= 0 && tx < WIDTH && ty < HEIGHT &&
			    mask[ty * WIDTH + tx]) {
				x = tx;
				y = ty;
				from = (way + 5) % 8;
				break;
			}
		}
		if (k == 8)
			break;
	} while ((uint32_t)(y * WIDTH + x) != start && out->count < POINTS_MAX - 1);
}

/* How far each pixel of a mask is from its end, roughly (3-4 chamfer, in thirds of a pixel). */
static void find_depths(uint32_t *depth, const uint8_t *mask)
{
	for (uint32_t at = 0; at < PIXELS; at++)
		depth[at] = mask[at] ? UINT32_MAX / 2 : 0;
#define BETTER(to, step) depth[at] = depth[to] + (step) < depth[at] ? depth[to] + (step) : depth[at]
	for (uint32_t y = 0, at = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++, at++) {
			if (!mask[at])
				continue;
			if (x == 0 || y == 0 || x + 1 == WIDTH || y + 1 == HEIGHT) {
				depth[at] = 3;
				continue;
			}
			BETTER(at - 1, 3);
			BETTER(at - WIDTH, 3);
			BETTER(at - WIDTH - 1, 4);
			BETTER(at - WIDTH + 1, 4);
		}
	for (uint32_t at = PIXELS; at-- > 0;) {
		const uint32_t x = at % WIDTH, y = at / WIDTH;

		if (!mask[at] || x == 0 || y == 0 || x + 1 == WIDTH || y + 1 == HEIGHT)
			continue;
		BETTER(at + 1, 3);
		BETTER(at + WIDTH, 3);
		BETTER(at + WIDTH + 1, 4);
		BETTER(at + WIDTH - 1, 4);
	}
#undef BETTER
}

/* A stroke through the middle of a piece: from its deepest pixel both ways along its longer axis,
 * as far as it is deep. */
static void through_middle(struct path *out, const uint8_t *mask)
{
	uint32_t *depth = malloc(PIXELS * sizeof(*depth)), deepest = 0;
	double sum[2] = { 0 }, square[3] = { 0 };
	uint32_t count = 0;

	find_depths(depth, mask);
	for (uint32_t at = 0; at < PIXELS; at++) {
		if (!mask[at])
			continue;
		const double x = at % WIDTH, y = at / WIDTH;
		deepest = depth[at] > depth[deepest] ? at : deepest;
		sum[0] += x;
		sum[1] += y;
		square[0] += x * x;
		square[1] += y * y;
		square[2] += x * y;
		count++;
	}
	out->count = 0;
	if (count > 0) {
		const double mx = sum[0] / count, my = sum[1] / count,
			     xx = square[0] / count - mx * mx, yy = square[1] / count - my * my,
			     xy = square[2] / count - mx * my;
		const double angle = 0.5 * atan2(2 * xy, xx - yy);
		const float sx = (float)(deepest % WIDTH) + 0.5f,
			    sy = (float)(deepest / WIDTH) + 0.5f;
		float ends[2][2];

		for (int way = 0; way < 2; way++) {
			const float cx = (float)cos(angle) * (way ? -1 : 1),
				    cy = (float)sin(angle) * (way ? -1 : 1);
			float t = 0;

			for (; t < 2000; t++) {
				const int x = (int)(sx + t * cx), y = (int)(sy + t * cy);
				if (x < 0 || y < 0 || x >= WIDTH || y >= HEIGHT ||
				    depth[y * WIDTH + x] * 2 < depth[deepest])
					break;
			}
			ends[way][0] = sx + t * cx;
			ends[way][1] = sy + t * cy;
		}
		const float length = hypotf(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
		for (float t = 0; t <= length; t += 4)
			add_point(out,
				  ends[0][0] + (ends[1][0] - ends[0][0]) * t / (length + 0.01f),
				  ends[0][1] + (ends[1][1] - ends[0][1]) * t / (length + 0.01f));
	}
	free(depth);
}

/* What a hand makes of a path: it cuts corners, trembles and slips. Returns seconds. */
static float draw_by_hand(struct path *path, bool closed, float width_px)
{
	const float tremble = 0.2f * width_px, slip = 0.5f * width_px;
	const int smooth = (int)(width_px * 0.8f) + 1;
	float(*out)[2] = malloc(POINTS_MAX * sizeof(*out)), away = 0, length = 0, slipping = 0,
	slip_by = 0;
	const uint32_t n = path->count;

	for (uint32_t i = 0; i < n; i++) {
		float sum[2] = { 0 };
		int count = 0;

		for (int k = -smooth; k <= smooth; k++) {
			int64_t at = (int64_t)i + k;

			if (closed)
				at = (at + n) % n;
			else if (at < 0 || at >= n)
				continue;
			sum[0] += path->points[at][0];
			sum[1] += path->points[at][1];
			count++;
		}
		out[i][0] = sum[0] / (float)count;
		out[i][1] = sum[1] / (float)count;
	}
	for (uint32_t i = 0; i < n; i++) {
		const float *next = out[(i + 3) % n], *before = out[(i + n - 3) % n];
		float along[2] = { next[0] - before[0], next[1] - before[1] };
		const float size = hypotf(along[0], along[1]) + 1e-6f;

		/* neighbouring errors are alike over about 25 pixels */
		away += -away / 25 + tremble * (float)normal_chance() * sqrtf(2.0f / 25);
		if (slipping <= 0 && chance() < 1.0 / 400) {
			slipping = 30;
			slip_by = slip * (chance() < 0.5 ? -1.0f : 1.0f);
		}
		slipping -= 1;
		const float by =
			away + (slipping > 0 ? slip_by * sinf((float)M_PI * slipping / 30) : 0);
		path->points[i][0] = out[i][0] - along[1] / size * by;
		path->points[i][1] = out[i][1] + along[0] / size * by;
		if (i > 0)
			length += hypotf(out[i][0] - out[i - 1][0], out[i][1] - out[i - 1][1]);
	}
	free(out);
	return begin_s + vec_most(length / width_px * steer_s, length / fastest_px_s);
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
	*pixels = largest_piece(out, wrong);
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
		      struct world *world, const struct view *view, struct path *path)
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
			trace(path, piece);
			outcome->hand_s += draw_by_hand(path, true, lasso_width_px);
			const struct stroke stroke = { (const float(*)[2])path->points, path->count,
						       1 };
			if (strokes_lasso(fill, WIDTH, HEIGHT, &stroke) == 0)
				for (uint32_t at = 0; at < PIXELS; at++)
					if (fill[at] == MARK_PART)
						in_part[at] = part;
		} else {
			through_middle(path, piece);
			outcome->hand_s += draw_by_hand(path, false, markup_width_px);
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
		    struct path *path)
{
	uint8_t *piece = malloc(PIXELS), *around = malloc(PIXELS);
	struct path outside = { malloc(POINTS_MAX * sizeof(*outside.points)), 0 };

	largest_piece(piece, view->truth);
	memset(marks, MARK_UNKNOWN, PIXELS);
	through_middle(path, piece);
	outcome->hand_s += draw_by_hand(path, false, markup_width_px);
	const struct stroke inside = { (const float(*)[2])path->points, path->count, 3 };
	strokes_paint(marks, WIDTH, HEIGHT, &inside, MARK_PART_SEED);
	/* beside it: along a border twelve pixels away, every other quarter of it */
	trace(path, piece);
	memset(around, 0, PIXELS);
	const struct stroke wide = { (const float(*)[2])path->points, path->count, 40 };
	strokes_paint(around, WIDTH, HEIGHT, &wide, 1);
	for (uint32_t at = 0; at < PIXELS; at++)
		around[at] = around[at] || piece[at];
	trace(&outside, around);
	for (uint32_t quarter = 0; quarter < 4; quarter++) {
		const uint32_t from = outside.count * (2 * quarter) / 8,
			       end = outside.count * (2 * quarter + 1) / 8;

		path->count = 0;
		for (uint32_t i = from; i < end; i++)
			add_point(path, outside.points[i][0], outside.points[i][1]);
		if (path->count < 8)
			continue;
		outcome->hand_s += draw_by_hand(path, false, markup_width_px);
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
	struct path path = { malloc(POINTS_MAX * sizeof(*path.points)), 0 };
	uint8_t *marks = malloc(PIXELS), *in_part = malloc(PIXELS), *piece = malloc(PIXELS);
	double error;

	memset(outcome, 0, sizeof(*outcome));
	if (tool == TOOL_MARKUP) {
		mark_up(outcome, marks, view, &path);
	} else {
		largest_piece(piece, view->truth);
		trace(&path, piece);
		outcome->strokes = 1;
		outcome->hand_s = draw_by_hand(
			&path, true, tool == TOOL_LASSO ? lasso_width_px : heavy_width_px);
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

static void do_part(struct world *world, const char *regions, const char *name, bool first)
{
	struct diagnostics diagnostics = { 0 };
	struct view view = { 0 };
	struct face_list list;
	uint32_t *triangles, count;
	char path[512];

	snprintf(path, sizeof(path), "%s/%s.faces", regions, name);
	if (face_list_read(&list, path, name, world->mesh.scans[0].face_count, &diagnostics) < 0) {
		fprintf(stderr, "%s: cannot be read\n", path);
		exit(1);
	}
	must(face_list_triangles(&triangles, &count, &list, &world->mesh, 0), "faces");
	open_view(world, &view, triangles, count);
	if (view.part_faces == 0) {
		fprintf(stderr, "%s: nothing of it is to be seen\n", name);
		exit(1);
	}
	printf("%s\n  {\"part\": \"%s\", \"faces\": %u, \"shown\": %u, \"superpixels\": %u, \"superpixels_ms\": %.1f, \"tools\": [",
	       first ? "" : ",", name, count, view.part_faces, view.superpixels.count,
	       view.superpixels_ms);
	for (int tool = 0; tool < TOOLS; tool++) {
		printf("%s\n    {\"tool\": \"%s\", \"runs\": [", tool > 0 ? "," : "",
		       tool_names[tool]);
		for (uint32_t seed = 0; seed < SEEDS; seed++) {
			struct outcome outcome;
			char picture[256];

			snprintf(picture, sizeof(picture), "%s-%s", name, tool_names[tool]);
			chance_state = seed * 7919 + 17;
			const double error = use_tool(&outcome, (enum tool)tool, world, &view,
						      seed == 0 ? picture : NULL);
			printf("%s{\"hand_s\": %.2f, \"compute_ms\": %.1f, \"longest_ms\": %.1f, \"strokes\": %u, \"first_error\": %.4f, \"error\": %.4f}",
			       seed ? ", " : "", (double)outcome.hand_s, outcome.compute_ms,
			       outcome.longest_ms, outcome.strokes, outcome.first_error, error);
		}
		printf("]}");
	}
	printf("]}");
	keep_picture(world, &view, view.truth, NULL, name);
	fflush(stdout);
	superpixels_finish(&view.superpixels);
	free(view.truth);
	free(triangles);
	face_list_finish(&list);
}

int main(int argc, char **argv)
{
	const struct import_options options = { 0 };
	struct diagnostics diagnostics = { 0 };
	struct world world = { 0 };
	bool first = true;
	char name[64];

	if (argc != 4) {
		fprintf(stderr, "usage: bench_regions TEMPLE.ply REGIONS PICTURES < parts\n");
		return 2;
	}
	world.folder = argv[3];
	mkdir(world.folder, 0777);
	must(import_scan(&world.mesh, argv[1], &options, NULL, &diagnostics), argv[1]);
	must(face_blocks_make(&world.blocks, &world.mesh), "blocks");
	must(chunks_create(&world.model, &world.mesh, (const uint8_t[3]){ 180, 170, 150 }),
	     "chunks");
	must(view_draw_create(&world.draw, WIDTH, HEIGHT), "picture");
	world.shown = calloc(world.mesh.triangle_count, 1);
	printf("{\"rows\": [");
	while (scanf("%63s", name) == 1) {
		do_part(&world, argv[2], name, first);
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
