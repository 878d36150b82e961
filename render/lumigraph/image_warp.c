/* Finds the depths of the grid, places and orders its mesh on the processor, and draws it. */
#include "render/lumigraph/image_warp.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

/* Where nothing was seen: so far that only turns move it. */
static const float sky_m = 1e6f;
/* The ring of cells reaches out by so much of half the picture. */
static const float ring = 0.5f;
/* How far the eye may have turned: 18 degrees. It may be as far away as what is nearest. */
static const float reach_angle = 0.314f;
/* How much of the view the picture may leave bare, which its edge is smeared over. */
static const float bare_most = 0.1f;
/* A depth from this share of the far limit on is nothing. */
static const float far_share = 0.99f;
/* Nearer than this share of the nearest depth a point counts as there: it is at the eye. */
static const float least_share = 0.02f;

static const char image_warp_vertex[] = "attribute vec4 a_point;\n"
					"varying vec2 v_at;\n"
					"void main() {\n"
					"	v_at = a_point.zw;\n"
					"	gl_Position = vec4(a_point.xy, 0.0, 1.0);\n"
					"}\n";

static const char image_warp_fragment[] = "uniform FINE sampler2D u_picture;\n"
					  "varying vec2 v_at;\n"
					  "void main() {\n"
					  "	gl_FragColor = texture2D(u_picture, v_at);\n"
					  "}\n";

/* Panels may be turned: where the view's axes are in the picture. */
static const char depth_vertex[] = "attribute vec2 a_position;\n"
				   "uniform vec4 u_axes;\n"
				   "varying vec2 v_at;\n"
				   "void main() {\n"
				   "	v_at = 0.5 * (a_position.x * u_axes.xy +\n"
				   "		      a_position.y * u_axes.zw) + 0.5;\n"
				   "	gl_Position = vec4(a_position, 0.0, 1.0);\n"
				   "}\n";

/* Three digits in base 255. 1 has none; what is drawn is nearer. */
static const char depth_fragment[] =
	"precision highp float;\n"
	"uniform highp sampler2D u_depths;\n"
	"varying vec2 v_at;\n"
	"void main() {\n"
	"	float depth = min(texture2D(u_depths, v_at).r, 0.9999999);\n"
	"	vec3 digits = fract(depth * vec3(1.0, 255.0, 65025.0));\n"
	"	gl_FragColor = vec4(digits - vec3(digits.yz / 255.0, 0.0), 1.0);\n"
	"}\n";

static int build_depths(struct image_warp *warp)
{
	const struct gl_program_source source = {
		.name = "depths of a picture",
		.vertex = (const char *const[]){ depth_vertex, NULL },
		.fragment = (const char *const[]){ depth_fragment, NULL },
		.attributes = gl_square_attributes,
	};
	int rc = gl_program_build(&warp->depth_program, &source);
	if (rc < 0)
		return rc;
	glUseProgram(warp->depth_program);
	glUniform1i(glGetUniformLocation(warp->depth_program, "u_depths"), 0);
	warp->axes = glGetUniformLocation(warp->depth_program, "u_axes");
	return 0;
}

bool image_warp_is_supported(void)
{
	return gl_has_extension("GL_OES_depth_texture") && gl_has_highp();
}

static int build(struct image_warp *warp)
{
	const struct gl_program_source source = {
		.name = "warp",
		.vertex = (const char *const[]){ image_warp_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, image_warp_fragment, NULL },
		.attributes = (const char *const[]){ "a_point", NULL },
	};
	int rc = gl_program_build(&warp->program, &source);
	if (rc < 0)
		return rc;
	glUseProgram(warp->program);
	glUniform1i(glGetUniformLocation(warp->program, "u_picture"), 0);
	return 0;
}

int image_warp_begin(struct image_warp *warp, struct image_warp_reference *reference, int width_px,
		     int height_px)
{
	struct gl_target *picture = &reference->picture;
	int rc = warp->program ? 0 : build(warp);
	if (rc == 0 && !warp->depth_program)
		rc = build_depths(warp);
	if (rc == 0 && !warp->depths.framebuffer)
		rc = gl_target_create_flat(&warp->depths, IMAGE_WARP_STEP * IMAGE_WARP_ACROSS,
					   IMAGE_WARP_STEP * IMAGE_WARP_UP);
	if (rc == 0 && !warp->pixels) {
		warp->pixels = malloc(4 * IMAGE_WARP_DEPTHS);
		rc = warp->pixels ? 0 : -ENOMEM;
	}
	if (rc < 0)
		return rc;
	if (picture->framebuffer && picture->width_px == width_px &&
	    picture->height_px == height_px) {
		gl_target_bind(picture);
		return 0;
	}
	gl_target_destroy(picture);
	rc = gl_target_create_deep(picture, width_px, height_px);
	if (rc == 0)
		gl_target_smooth(picture);
	return rc;
}

void image_warp_let_go(struct image_warp_reference *reference)
{
	gl_target_destroy(&reference->picture);
}

void image_warp_finish(struct image_warp *warp)
{
	if (warp->program)
		glDeleteProgram(warp->program);
	if (warp->depth_program)
		glDeleteProgram(warp->depth_program);
	gl_target_destroy(&warp->depths);
	free(warp->pixels);
	warp->pixels = NULL;
	warp->program = warp->depth_program = 0;
}

/* ---- the points of the grid */

/* Returns where a column or row of points is, -1..1 within the picture. */
static float across(int i, int cells)
{
	if (i == 0)
		return -1 - ring;
	if (i == cells + 2)
		return 1 + ring;
	return 2 * (float)(i - 1) / (float)cells - 1;
}

static float share(float at)
{
	return fminf(fmaxf((at + 1) / 2, 0), 1);
}

/* Writes the way of a point of the mesh from the reference's eye, per metre of depth. */
static void find_way(float along[3], const struct view *from, int i, int j)
{
	const float x = from->tan_x * across(i, IMAGE_WARP_ACROSS);
	const float y = from->tan_y * across(j, IMAGE_WARP_UP);
	for (int k = 0; k < 3; k++)
		along[k] = from->forward[k] + x * from->right[k] + y * from->up[k];
}

/* Writes where a direction or a place relative to the eye is in clip space, before the division.
 * The matrix turns it as the panel is. */
static void clip_place(float out[2], const struct view *view, const float to[3])
{
	for (int k = 0; k < 2; k++)
		out[k] = view->clip[k] * to[0] + view->clip[4 + k] * to[1] +
			 view->clip[8 + k] * to[2];
}

/* ---- depths */

/* How a view's projection has depths: z of clip space, divided, is a + b / depth. */
struct projection {
	float a, b;
};

static struct projection projection_of(const struct view *view)
{
	const float along[3] = { view->clip[2], view->clip[6], view->clip[10] };
	return (struct projection){ .a = vec_dot(along, view->forward), .b = view->clip[14] };
}

/* Returns a depth that was read, in metres. */
static float depth_m(struct projection projection, const uint8_t digits[3])
{
	const float far_m = projection.b / (1 - projection.a);
	const double depth = digits[0] / 255.0 + digits[1] / 65025.0 + digits[2] / 16581375.0;
	const float m = (float)(projection.b / (2 * depth - 1 - (double)projection.a));
	return m > 0 && m < far_share * far_m ? m : sky_m;
}

/* Returns the least in a cell. */
static float depth_in_cell(struct projection projection, const uint8_t *depths, int i, int j)
{
	const uint8_t *nearest = NULL;
	for (int y = j * IMAGE_WARP_STEP; y < (j + 1) * IMAGE_WARP_STEP; y++) {
		const uint8_t *row = depths + 4 * (size_t)(y * IMAGE_WARP_ACROSS * IMAGE_WARP_STEP);
		for (int x = i * IMAGE_WARP_STEP; x < (i + 1) * IMAGE_WARP_STEP; x++)
			if (!nearest || memcmp(row + 4 * x, nearest, 3) < 0)
				nearest = row + 4 * x;
	}
	return depth_m(projection, nearest);
}

/* Returns the least of the cells around a point: a cell that shows anything near is near as a
 * whole, so that only what is behind gets stretched. */
static float depth_around(float cells[IMAGE_WARP_UP][IMAGE_WARP_ACROSS], int i, int j)
{
	float nearest = sky_m;
	for (int y = j - 1; y <= j; y++)
		for (int x = i - 1; x <= i; x++)
			if (x >= 0 && y >= 0 && x < IMAGE_WARP_ACROSS && y < IMAGE_WARP_UP)
				nearest = fminf(nearest, cells[y][x]);
	return nearest;
}

static int within(int value, int most)
{
	return value < 0 ? 0 : value > most ? most : value;
}

void image_warp_take_depths(struct image_warp_reference *reference, const uint8_t *depths)
{
	const struct projection projection = projection_of(&reference->view);
	float cells[IMAGE_WARP_UP][IMAGE_WARP_ACROSS];
	for (int j = 0; j < IMAGE_WARP_UP; j++)
		for (int i = 0; i < IMAGE_WARP_ACROSS; i++)
			cells[j][i] = depth_in_cell(projection, depths, i, j);
	reference->nearest_m = sky_m;
	for (int j = 0; j < IMAGE_WARP_ROWS; j++) {
		for (int i = 0; i < IMAGE_WARP_COLUMNS; i++) {
			const float depth = depth_around(cells, within(i - 1, IMAGE_WARP_ACROSS),
							 within(j - 1, IMAGE_WARP_UP));
			reference->depth_m[j * IMAGE_WARP_COLUMNS + i] = depth;
			reference->nearest_m = fminf(reference->nearest_m, depth);
		}
	}
}

int image_warp_read_depths(struct image_warp *warp, struct image_warp_reference *reference)
{
	const struct view *view = &reference->view;
	float right[2], up[2];
	clip_place(right, view, view->right);
	clip_place(up, view, view->up);
	gl_target_bind(&warp->depths);
	glDisable(GL_BLEND);
	glDisable(GL_DEPTH_TEST);
	glUseProgram(warp->depth_program);
	glUniform4f(warp->axes, right[0] * view->tan_x, right[1] * view->tan_x, up[0] * view->tan_y,
		    up[1] * view->tan_y);
	gl_bind_texture(0, reference->picture.depths);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	gl_draw_square();
	glEnable(GL_DEPTH_TEST);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, warp->depths.width_px, warp->depths.height_px, GL_RGBA, GL_UNSIGNED_BYTE,
		     warp->pixels);
	const int rc = gl_check("reading the depths of a picture");
	if (rc == 0)
		image_warp_take_depths(reference, warp->pixels);
	return rc;
}

/* ---- the mesh */

/* Writes where a point of the mesh is, relative to the view's eye. Returns its depth in the view,
 * never behind the eye. */
static float place_point(float to[3], const struct image_warp_reference *reference,
			 const struct view *view, const float along[3], int n)
{
	vec_sub(to, reference->view.eye_m, view->eye_m);
	vec_add_scaled(to, to, reference->depth_m[n], along);
	return fmaxf(vec_dot(to, view->forward), least_share * reference->nearest_m);
}

/* Returns the share of the view beyond a point of the picture's edge, along an axis of the view
 * towards that edge. */
static float beyond(const struct image_warp_reference *reference, const struct view *view, int i,
		    int j, const float axis[3], float tangent)
{
	float along[3], to[3];
	find_way(along, &reference->view, i, j);
	const float z = place_point(to, reference, view, along, j * IMAGE_WARP_COLUMNS + i);
	return share(-vec_dot(to, axis) / (z * tangent));
}

/* Returns about how much of the view the picture leaves bare: the sum of what each edge does. */
static float find_bare(const struct image_warp_reference *reference, const struct view *view)
{
	const int right = IMAGE_WARP_COLUMNS - 2, top = IMAGE_WARP_ROWS - 2;
	float sides = 0, ends = 0;
	for (int j = 1; j <= top; j++)
		sides += beyond(reference, view, 1, j, view->right, -view->tan_x) +
			 beyond(reference, view, right, j, view->right, view->tan_x);
	for (int i = 1; i <= right; i++)
		ends += beyond(reference, view, i, 1, view->up, -view->tan_y) +
			beyond(reference, view, i, top, view->up, view->tan_y);
	return sides / (float)top + ends / (float)right;
}

float image_warp_off(const struct image_warp_reference *reference, const struct view *view)
{
	const float cosine = fminf(vec_dot(reference->view.forward, view->forward), 1);
	const float moved_m = vec_distance(reference->view.eye_m, view->eye_m);
	return fmaxf(fmaxf(acosf(cosine) / reach_angle, moved_m / reference->nearest_m),
		     find_bare(reference, view) / bare_most);
}

void image_warp_place(struct image_warp *warp, const struct image_warp_reference *reference,
		      const struct view *view)
{
	const struct view *from = &reference->view;
	for (int j = 0; j < IMAGE_WARP_ROWS; j++) {
		for (int i = 0; i < IMAGE_WARP_COLUMNS; i++) {
			const int n = j * IMAGE_WARP_COLUMNS + i;
			float along[3], to[3], was[2], is[2];
			find_way(along, from, i, j);
			const float z = place_point(to, reference, view, along, n);
			clip_place(was, from, along);
			clip_place(is, view, to);
			warp->point[n] = (struct image_warp_point){ .x = is[0] / z,
								    .y = is[1] / z,
								    .u = share(was[0]),
								    .v = share(was[1]) };
		}
	}
}

/* Writes the two triangles of a cell. */
static uint16_t *add_cell(uint16_t *at, int i, int j)
{
	const uint16_t low = (uint16_t)(j * IMAGE_WARP_COLUMNS + i);
	const uint16_t high = (uint16_t)(low + IMAGE_WARP_COLUMNS);
	const uint16_t cell[6] = { low, (uint16_t)(low + 1),  (uint16_t)(high + 1),
				   low, (uint16_t)(high + 1), high };
	memcpy(at, cell, sizeof(cell));
	return at + 6;
}

/* Writes the cells between two points, first to last or last to first on each axis. */
static uint16_t *add_sheet(uint16_t *at, const int low[2], const int high[2], const bool falls[2])
{
	for (int b = 0; b < high[1] - low[1]; b++)
		for (int a = 0; a < high[0] - low[0]; a++)
			at = add_cell(at, falls[0] ? high[0] - 1 - a : low[0] + a,
				      falls[1] ? high[1] - 1 - b : low[1] + b);
	return at;
}

/* Returns the column or row next to the epipole: where the picture shows the eye, or would. */
static int epipole(float aside_m, float ahead_m, float tangent, int cells)
{
	const float at = (aside_m / (ahead_m * tangent) + 1) / 2 * (float)cells + 1;
	return (int)fminf(fmaxf(at, 0), (float)(cells + 2));
}

/* Rays of the eye are lines through the epipole there. If the eye is in front of the reference's,
 * what is farther along a ray is farther from the epipole, so all is drawn towards it; if it is
 * behind, away from it. In each of the four quadrants around it, that is one order of columns and
 * rows. */
void image_warp_order(struct image_warp *warp, const struct image_warp_reference *reference,
		      const struct view *view)
{
	const struct view *from = &reference->view;
	float moved_m[3];
	vec_sub(moved_m, view->eye_m, from->eye_m);
	float ahead_m = vec_dot(moved_m, from->forward);
	/* An eye that moves aside is a little in front, and its epipole far outside. */
	if (fabsf(ahead_m) < 1e-9f)
		ahead_m = 1e-9f;
	const int middle[2] = {
		epipole(vec_dot(moved_m, from->right), ahead_m, from->tan_x, IMAGE_WARP_ACROSS),
		epipole(vec_dot(moved_m, from->up), ahead_m, from->tan_y, IMAGE_WARP_UP),
	};
	const int end[2] = { IMAGE_WARP_COLUMNS - 1, IMAGE_WARP_ROWS - 1 };
	uint16_t *at = warp->index;
	for (int quadrant = 0; quadrant < 4; quadrant++) {
		int low[2], high[2];
		bool falls[2];
		for (int k = 0; k < 2; k++) {
			const bool upper = quadrant >> k & 1;
			low[k] = upper ? middle[k] : 0;
			high[k] = upper ? end[k] : middle[k];
			falls[k] = upper == (ahead_m > 0);
		}
		at = add_sheet(at, low, high, falls);
	}
}

void image_warp_draw(struct image_warp *warp, const struct image_warp_reference *reference,
		     const struct view *view, const struct gl_place *place)
{
	image_warp_place(warp, reference, view);
	image_warp_order(warp, reference, view);
	gl_place_bind(place, view->width_px, view->height_px);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glDisable(GL_DEPTH_TEST);
	glUseProgram(warp->program);
	gl_bind_texture(0, reference->picture.colour);
	glBindBuffer(GL_ARRAY_BUFFER, 0);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, 0);
	glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, warp->point);
	glEnableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	glDrawElements(GL_TRIANGLES, IMAGE_WARP_INDICES, GL_UNSIGNED_SHORT, warp->index);
	glDisableVertexAttribArray(0);
	glEnable(GL_DEPTH_TEST);
}
