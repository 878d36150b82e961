/* Renders a face of a sampling point as depths and packs them, with grown silhouettes, into a
 * sheet. */
#include "render/lumigraph/depth.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "geometry/vec.h"
#include "render/lumigraph/aim.h"

static const char draw_vertex[] =
	"attribute vec3 a_position, a_base;\n"
	"uniform vec4 u_lattice;\n" /* lattice origin relative to the point, metres; step */
	"uniform mat3 u_axes;\n"
	"uniform float u_far;\n"
	"uniform vec4 u_window;\n"
	"uniform vec2 u_base;\n" /* reference depth in units; metres per unit */
	"uniform float u_high;\n"
	"varying vec2 v_depth;\n" /* y: higher byte of the base, the same at all vertices */
	"void main() {\n"
	"	vec3 q = u_axes * (u_lattice.xyz + u_lattice.w * (a_base + a_position));\n"
	/* Sampling points are as far apart, and as far from the model, as its size allows. */
	"	float n = u_far * 0.0007;\n"
	/* Row 0 of a face is at the top, row 0 of a texture at the bottom: y is flipped. */
	"	vec2 at = (q.xy - u_window.xy * q.z) / u_window.zw;\n"
	"	gl_Position = vec4(at.x, -at.y, ((u_far + n) * q.z - 2.0 * u_far * n) / (u_far - n),\n"
	"			   q.z);\n"
	"	v_depth = vec2(q.z / u_base.y - u_base.x, u_high);\n"
	"}\n";

/* Writes two bytes. A unit (32 steps) is an eighth of the higher byte. */
static const char draw_fragment[] =
	"varying vec2 v_depth;\n"
	"void main() {\n"
	"	float high = floor(v_depth.x / 8.0);\n"
	"	float low = floor((v_depth.x - 8.0 * high) * 32.0);\n"
	"	gl_FragColor = vec4(clamp(floor(v_depth.y + 0.5) + high, 0.0, 255.0), low, 0.0, 255.0) / 255.0;\n"
	"}\n";

/* The two bytes stay separate, because mediump cannot hold 16 bits; 11 bits suffice to compare
 * which is nearer. */
static const char grow_fragment[] =
	"uniform FINE sampler2D u_raw;\n" /* the default is lowp */
	"uniform float u_texel;\n"
	"varying vec2 v_at;\n"
	"vec3 depth_at(vec2 at) {\n" /* the two bytes; both as one number */
	"	vec4 t = texture2D(u_raw, at);\n"
	"	vec2 d = t.a < 0.5 ? vec2(255.0) : floor(t.rg * 255.0 + 0.5);\n"
	"	return vec3(d, d.x + d.y / 256.0);\n"
	"}\n"
	"void main() {\n"
	"	vec3 own = depth_at(v_at), nearest = own;\n"
	"	for (int y = -1; y <= 1; y++)\n"
	"		for (int x = -1; x <= 1; x++) {\n"
	"			vec3 d = depth_at(v_at + u_texel * vec2(float(x), float(y)));\n"
	"			nearest = d.z < nearest.z ? d : nearest;\n"
	"		}\n"
	/* A depth step: more than a surface seen at a grazing angle changes within a texel. */
	"	vec2 d = own.z - nearest.z > 0.06 * own.z ? nearest.xy : own.xy;\n"
	"	float high = floor(d.x / 8.0), middle = floor(d.y / 32.0);\n"
	"	gl_FragColor = vec4(high / 31.0, ((d.x - 8.0 * high) * 8.0 + middle) / 63.0,\n"
	"			    (d.y - 32.0 * middle) / 31.0, 1.0);\n"
	"}\n";

static int build_programs(struct depth *depth)
{
	const struct gl_program_source draw = {
		.name = "face depth",
		.vertex = (const char *const[]){ draw_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, draw_fragment, NULL },
		.attributes = (const char *const[]){ "a_position", "a_normal", "a_colour", "a_base",
						     NULL },
	};
	const struct gl_program_source grow = {
		.name = "face depth, grown",
		.vertex = (const char *const[]){ gl_square_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, grow_fragment, NULL },
		.attributes = gl_square_attributes,
	};
	int rc = gl_program_build(&depth->draw_program, &draw);
	if (rc == 0)
		rc = gl_program_build(&depth->grow_program, &grow);
	if (rc < 0)
		return rc;
	depth->lattice = glGetUniformLocation(depth->draw_program, "u_lattice");
	depth->axes = glGetUniformLocation(depth->draw_program, "u_axes");
	depth->far_m = glGetUniformLocation(depth->draw_program, "u_far");
	depth->window = glGetUniformLocation(depth->draw_program, "u_window");
	depth->base = glGetUniformLocation(depth->draw_program, "u_base");
	depth->high = glGetUniformLocation(depth->draw_program, "u_high");
	glUseProgram(depth->grow_program);
	glUniform1i(glGetUniformLocation(depth->grow_program, "u_raw"), 0);
	glUniform1f(glGetUniformLocation(depth->grow_program, "u_texel"),
		    1.0f / (float)depth->layout.face_px);
	return 0;
}

/* Makes a texture of depths and its framebuffer. -ENOTSUP: the driver cannot draw into it. */
static int make_sheet_of(struct depth *depth, int at, int width_px, int height_px)
{
	const struct gl_texture_options sheet = { .width_px = width_px,
						  .height_px = height_px,
						  .format = depth->format,
						  .type = depth->type,
						  .filter = GL_NEAREST,
						  .repeat = depth->repeats };
	int rc = gl_texture_create(&depth->sheet[at], &sheet);
	if (rc < 0)
		return rc;
	glGenFramebuffers(1, &depth->framebuffer[at]);
	gl_bind_framebuffer(depth->framebuffer[at]);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
			       depth->sheet[at], 0);
	const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
	rc = gl_check("making a sheet of depths");
	return rc == 0 && !complete ? -ENOTSUP : rc;
}

static void drop_sheet(struct depth *depth, int at)
{
	glDeleteFramebuffers(1, &depth->framebuffer[at]);
	glDeleteTextures(1, &depth->sheet[at]);
	depth->framebuffer[at] = depth->sheet[at] = 0;
}

/* GLES2 does not guarantee which formats can be drawn into; 5, 6 and 5 bits fit into 8 as well. */
static int choose_format(struct depth *depth)
{
	static const GLenum formats[][2] = { { GL_RGB, GL_UNSIGNED_SHORT_5_6_5 },
					     { GL_RGBA, GL_UNSIGNED_BYTE } };
	int rc = -ENOTSUP;
	for (size_t i = 0; i < ARRAY_COUNT(formats) && rc == -ENOTSUP; i++) {
		depth->format = formats[i][0];
		depth->type = formats[i][1];
		rc = make_sheet_of(depth, 0, 1, 1);
		drop_sheet(depth, 0);
	}
	return rc;
}

/* With the first face there, not at the start, like the atlas (tiles.c). */
static int make_sheet(struct depth *depth, int at)
{
	const struct depth_layout *layout = &depth->layout;
	int rc;
	if (depth->sheet[at])
		return 0;
	rc = make_sheet_of(depth, at, layout->across * layout->face_px,
			   layout->rows * layout->face_px);
	if (rc < 0)
		drop_sheet(depth, at);
	return rc;
}

int depth_init(struct depth *depth, const struct depth_layout *layout)
{
	memset(depth, 0, sizeof(*depth));
	depth->layout = *layout;
	depth->repeats = !gl_has_highp();
	depth->far_limit_m = 1;
	int rc = build_programs(depth);
	if (rc == 0)
		rc = gl_target_create(&depth->raw, layout->face_px, layout->face_px);
	if (rc == 0)
		rc = choose_format(depth);
	if (rc < 0)
		depth_finish(depth);
	return rc;
}

void depth_finish(struct depth *depth)
{
	gl_target_destroy(&depth->raw);
	if (depth->draw_program) { /* otherwise there may be no context */
		glDeleteFramebuffers(DEPTH_SHEETS_MAX, depth->framebuffer);
		glDeleteTextures(DEPTH_SHEETS_MAX, depth->sheet);
		glDeleteProgram(depth->draw_program);
	}
	if (depth->grow_program)
		glDeleteProgram(depth->grow_program);
	memset(depth, 0, sizeof(*depth));
}

void depth_clear(struct depth *depth, float far_m)
{
	memset(depth->face, 0, sizeof(depth->face));
	depth->far_limit_m = far_m;
}

float depth_slack_m(const struct depth *depth)
{
	return depth->far_limit_m / 6800;
}

/* ---- windows */

struct rectangle {
	float low[2], high[2];
};

/* Extends the rectangle by the visible part of an edge in the plane of the face; the part behind
 * the point is ignored. */
static void add_edge(struct rectangle *out, const float a[3], const float b[3])
{
	const float least = 1e-3f, *ends[2] = { a, b };
	for (int i = 0; i < 2; i++) {
		const float *p = ends[i], *q = ends[1 - i];
		float part = p[2] >= least ? 0 : (least - p[2]) / (q[2] - p[2]);
		if (p[2] < least && q[2] < least)
			return;
		float z = p[2] + part * (q[2] - p[2]);
		for (int k = 0; k < 2; k++) {
			float at = (p[k] + part * (q[k] - p[k])) / z;
			out->low[k] = vec_least(out->low[k], at);
			out->high[k] = vec_most(out->high[k], at);
		}
	}
}

/* Writes the area of the face in which the model's box is visible, with a border of a texel. */
static void find_window(float window[4], const struct cube_axes *axes, const float sample_m[3],
			const struct root_page *root, int face_px)
{
	struct rectangle r = { { 1, 1 }, { -1, -1 } };
	float corner[8][3];
	for (int c = 0; c < 8; c++) {
		float to[3];
		for (int i = 0; i < 3; i++)
			to[i] = (c >> i & 1 ? root->box_max_m[i] : root->box_min_m[i]) -
				sample_m[i];
		corner[c][0] = vec_dot(to, axes->right);
		corner[c][1] = vec_dot(to, axes->up);
		corner[c][2] = vec_dot(to, axes->forward);
	}
	for (int c = 0; c < 8; c++)
		for (int i = 0; i < 3; i++)
			if (!(c >> i & 1))
				add_edge(&r, corner[c], corner[c | 1 << i]);
	for (int k = 0; k < 2; k++) {
		float texel = 4 / (float)face_px;
		float low = vec_most(r.low[k] - texel, -1), high = vec_least(r.high[k] + texel, 1);
		if (high - low < texel) {
			low = -1;
			high = 1;
		}
		window[k] = (low + high) / 2;
		window[2 + k] = (high - low) / 2;
	}
}

/* ---- faces */

void depth_resume(struct depth *depth, face_key face, const float sample_m[3],
		  const struct root_page *root)
{
	const struct lattice *lattice = &root->lattice;
	const struct cube_axes *axes = &cube_axes[face % CUBE_FACES];
	float columns[9];
	for (int i = 0; i < 3; i++) {
		columns[3 * i + 0] = axes->right[i];
		columns[3 * i + 1] = axes->up[i];
		columns[3 * i + 2] = axes->forward[i];
	}
	gl_target_bind(&depth->raw);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	glUseProgram(depth->draw_program);
	glUniform4f(depth->lattice, (float)(lattice->origin_m[0] - sample_m[0]),
		    (float)(lattice->origin_m[1] - sample_m[1]),
		    (float)(lattice->origin_m[2] - sample_m[2]), (float)lattice->step_m);
	glUniformMatrix3fv(depth->axes, 1, GL_FALSE, columns);
	glUniform1f(depth->far_m, depth->far_limit_m);
	glUniform4fv(depth->window, 1, depth->begun);
	memcpy(depth->forward, axes->forward, sizeof(depth->forward));
	depth->point_m = vec_dot(axes->forward, sample_m);
}

void depth_begin(struct depth *depth, face_key face, const float sample_m[3],
		 const struct root_page *root)
{
	find_window(depth->begun, &cube_axes[face % CUBE_FACES], sample_m, root,
		    depth->layout.face_px);
	depth_resume(depth, face, sample_m, root);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void depth_patch(const struct depth *depth, const float centre_m[3])
{
	float unit_m = aim_unit_m(depth->far_limit_m);
	float units = (vec_dot(depth->forward, centre_m) - depth->point_m) / unit_m;
	float high = floorf(units / 8);
	glUniform2f(depth->base, 8 * high, unit_m);
	glUniform1f(depth->high, high);
}

static void write_square(const struct depth *depth, struct depth_place place)
{
	int side_px = depth->layout.face_px;
	gl_bind_framebuffer(depth->framebuffer[place.sheet]);
	glViewport(place.column * side_px, place.row * side_px, side_px, side_px);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_DITHER); /* dithering would damage the packed bits */
	glUseProgram(depth->grow_program);
	gl_bind_texture(0, depth->raw.colour);
	gl_draw_square();
	glEnable(GL_DEPTH_TEST);
}

void depth_end(struct depth *depth, int slot, face_key face, uint64_t cut)
{
	struct depth_place place = depth_place(depth, slot);
	if (make_sheet(depth, place.sheet) == 0)
		write_square(depth, place);
	struct depth_face *drawn = &depth->face[slot];
	*drawn = (struct depth_face){ .ready = true, .key = face, .cut = cut };
	memcpy(drawn->window, depth->begun, sizeof(drawn->window));
}

struct depth_place depth_place(const struct depth *depth, int slot)
{
	const struct depth_layout *layout = &depth->layout;
	int row = slot / layout->across;
	return (struct depth_place){ .sheet = row / layout->rows,
				     .column = slot % layout->across,
				     .row = row % layout->rows };
}

bool depth_ready(const struct depth *depth, int slot, face_key face)
{
	return depth->face[slot].ready && depth->face[slot].key == face;
}
