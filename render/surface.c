#include "render/surface.h"

#include <stdio.h>
#include <string.h>

#include "format/light.h"

/* Positions are metres relative to the eye, so that floats suffice anywhere in the model. */
static const char vertex_common[] =
	"invariant gl_Position;\n" /* the mark is drawn over it at equal depth */
	"attribute vec3 a_position;\n"
	"attribute vec2 a_normal;\n"
	"attribute vec4 a_colour;\n"
	"uniform mat4 u_clip;\n"
	"uniform vec4 u_lattice;\n" /* origin from the eye, step */
	"uniform vec4 u_sun;\n"     /* direction, 1 where the model is lit */
	"varying vec4 v_colour;\n"  /* a: weight of the own colour among the images */
	"vec3 unit_normal() {\n"
	"	vec2 e = a_normal / 127.0;\n"
	"	vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));\n"
	"	if (n.z < 0.0)\n"
	"		n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0,\n"
	"						n.y < 0.0 ? -1.0 : 1.0);\n"
	"	return normalize(n);\n"
	"}\n"
	"vec3 own_colour(vec3 n) {\n"
	"	float l = u_sun.w > 0.5 ? light(n, a_colour.a, u_sun.xyz) : 1.0;\n"
	"	return min(a_colour.rgb * l, 1.0);\n"
	"}\n";

static const char plain_vertex[] = "void main() {\n"
				   "	vec3 p = u_lattice.xyz + u_lattice.w * a_position;\n"
				   "	v_colour = vec4(own_colour(unit_normal()), 1.0);\n"
				   "	gl_Position = u_clip * vec4(p, 1.0);\n"
				   "}\n";

/* A number of each pixel's own, spread evenly over any few neighbours (Jimenez 2014, "Next
 * generation post processing in Call of Duty: Advanced Warfare", interleaved gradient noise). */
static const char dissolve_none[] = "void dissolve() {}\n";
static const char dissolve_some[] =
	"uniform highp vec2 u_range;\n"
	"void dissolve() {\n"
	"	highp float u = fract(52.9829189 * fract(dot(gl_FragCoord.xy,\n"
	"						   vec2(0.06711056, 0.00583715))));\n"
	"	if (u < u_range.x || u >= u_range.y)\n"
	"		discard;\n"
	"}\n";

static const char plain_fragment[] = "varying vec4 v_colour;\n"
				     "uniform float u_share;\n"
				     "void main() {\n"
				     "	dissolve();\n"
				     "	gl_FragColor = vec4(v_colour.rgb * (1.0 - u_share), 1.0);\n"
				     "}\n";

/* Per face five rows: right, up, forward (xyz, and minus their product with the point), the point
 * and the blend's weight, and (half_px, 0, 0, 0). The quality is plan_quality's twin. */
static const char blended_vertex[] =
	"uniform vec4 u_face[5 * FACES];\n"
	"uniform vec4 u_eye;\n"     /* focal_px, error_m, even, spacing by its penalty */
	"uniform vec4 u_tune[2];\n" /* blur, parallax, angle, 0; facing low, 1 / (high - low) */
	"varying vec4 v_face[FACES];\n"
	"float quality(vec3 p, vec3 n, vec3 s, float depth, float half_px) {\n"
	"	float d = length(p);\n"
	"	vec3 to_eye = -p / d, to_sample = normalize(s - p);\n"
	"	float side = dot(to_eye, n) < 0.0 ? -1.0 : 1.0;\n"
	"	float cs = side * dot(to_sample, n), ce = side * dot(to_eye, n);\n"
	"	float ca = dot(to_eye, to_sample);\n"
	"	float facing = clamp((cs - u_tune[1].x) * u_tune[1].y, 0.0, 1.0);\n"
	"	float needed = u_eye.x * depth / d * sqrt(max(ce, 0.05) / max(cs, 0.05));\n"
	"	float blur = max(needed / half_px - 1.0, 0.0);\n"
	"	float sine = sqrt(max(1.0 - ca * ca, 0.0));\n"
	"	if (ca < 0.0) sine = 2.0 - sine;\n"
	"	float shift = u_eye.y * u_eye.x / d * sine;\n"
	"	float penalty = 1.0 + u_tune[0].x * blur + u_tune[0].y * shift\n"
	"			+ u_tune[0].z * (1.0 - ca);\n"
	"	return facing / (penalty * penalty);\n"
	"}\n"
	"vec4 seen(vec3 p, vec3 n, vec4 r, vec4 u, vec4 f, vec4 s, vec4 size) {\n"
	"	if (s.w <= 0.0)\n"
	"		return vec4(0.0, 0.0, 1.0, 0.0);\n"
	"	vec3 q = vec3(dot(r.xyz, p) + r.w, dot(u.xyz, p) + u.w, dot(f.xyz, p) + f.w);\n"
	"	float k = u_eye.z < 0.5 ? quality(p, n, s.xyz, max(q.z, 1e-5), size.x) : 1.0;\n"
	"	return vec4(q, s.w * k);\n"
	"}\n"
	"float sharpen(float k) { return k * k * k * k; }\n"
	"void main() {\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * a_position;\n"
	"	vec3 n = unit_normal();\n"
	"	float most = 0.0;\n"
	"	for (int i = 0; i < FACES; i++) {\n"
	"		v_face[i] = seen(p, n, u_face[5 * i], u_face[5 * i + 1], u_face[5 * i + 2],\n"
	"				 u_face[5 * i + 3], u_face[5 * i + 4]);\n"
	"		most = max(most, v_face[i].w);\n"
	"	}\n"
	"	float own = 1.0 + u_eye.w * u_eye.x / length(p);\n"
	"	own = u_eye.z < 0.5 ? 1.0 / (own * own) : 0.01;\n"
	"	most = max(most, own);\n"
	"	for (int i = 0; i < FACES; i++)\n"
	"		v_face[i].w = sharpen(v_face[i].w / most);\n"
	"	v_colour = vec4(own_colour(n), OWN_SHARE * sharpen(own / most) + 0.0005);\n"
	"	gl_Position = u_clip * vec4(p, 1.0);\n"
	"}\n";

/* Constants that C and GLSL share come first, made by set_constants. */
static const char blended_fragment[] =
	"uniform sampler2D u_tiles;\n"
	"uniform highp sampler2D u_cells, u_depths;\n" /* by default lowp: 16 bits need more */
	"uniform vec4 u_slot[FACES];\n"                /* face slot's column and row, 0, 0 */
	"uniform vec4 u_window[FACES];\n"              /* place in the depths: scale, offset */
	"uniform float u_share, u_far, u_slack;\n"
	"varying vec4 v_colour;\n"
	"varying vec4 v_face[FACES];\n"
	"vec4 from_face(vec4 face, vec2 slot, vec4 window) {\n"
	"	if (face.w < 0.0005 || face.z < u_far * 0.0004)\n"
	"		return vec4(0.0);\n"
	"	vec2 at = vec2(face.x, -face.y) / face.z;\n"
	"	if (abs(at.x) > 1.0 || abs(at.y) > 1.0)\n"
	"		return vec4(0.0);\n"
	"	vec3 d = texture2D(u_depths, at * window.xy + window.zw).rgb;\n"
	"	d = floor(d * vec3(31.0, 63.0, 31.0) + 0.5);\n" /* 5, 6, 5 bits; some return 8 */
	"	float depth = dot(d, vec3(2048.0, 32.0, 1.0)) / 65535.0 * u_far;\n"
	"	at = clamp(at * 0.5 + 0.5, 0.0001, 0.9999);\n"
	"	float slack = u_slack + 0.001 * face.z;\n"
	"	float w = face.w * clamp(2.0 - (face.z - depth) / slack, 0.0, 1.0);\n"
	"	if (w < 0.0002)\n"
	"		return vec4(0.0);\n"
	"	vec4 cell = texture2D(u_cells, (slot + at) / CELL_GRID) * 255.0;\n"
	"	vec2 local = fract(at * floor(cell.b + 0.5));\n"
	"	vec2 pixel = floor(cell.rg + 0.5) * IMAGE_PX + APRON_PX + local * TILE_PX;\n"
	"	w *= cell.a / 255.0;\n"
	"	vec3 colour = texture2D(u_tiles, pixel / ATLAS_PX).rgb;\n"
	"	vec3 off = colour - v_colour.rgb;\n"
	"	w /= 1.0 + DOUBT * dot(off, off);\n"
	"	return vec4(colour * w, w);\n"
	"}\n"
	"void main() {\n"
	"	dissolve();\n"
	"	vec4 sum = vec4(0.0);\n"
	"	for (int i = 0; i < FACES; i++)\n"
	"		sum += from_face(v_face[i], u_slot[i].xy, u_window[i]);\n"
	"	float own = v_colour.a;\n"
	"	vec3 colour = (sum.rgb + own * v_colour.rgb) / (sum.a + own);\n"
	"	float share = sum.a / (sum.a + own);\n"
	"	gl_FragColor = vec4(mix(colour, vec3(share), u_share), 1.0);\n"
	"}\n";

static void find_uniforms(struct surface_program *p)
{
	p->clip = glGetUniformLocation(p->program, "u_clip");
	p->lattice = glGetUniformLocation(p->program, "u_lattice");
	p->sun = glGetUniformLocation(p->program, "u_sun");
	p->eye = glGetUniformLocation(p->program, "u_eye");
	p->face = glGetUniformLocation(p->program, "u_face");
	p->slot = glGetUniformLocation(p->program, "u_slot");
	p->window = glGetUniformLocation(p->program, "u_window");
	p->tune = glGetUniformLocation(p->program, "u_tune");
	p->share = glGetUniformLocation(p->program, "u_share");
	p->far_m = glGetUniformLocation(p->program, "u_far");
	p->slack = glGetUniformLocation(p->program, "u_slack");
	p->range = glGetUniformLocation(p->program, "u_range");
}

static void set_constants(char *out, size_t bytes, const struct tiles *tiles, int faces)
{
	snprintf(out, bytes,
		 "precision highp float;\n"
		 "#define FACES %d\n"
		 "#define CELL_GRID vec2(%d.0, %d.0)\n"
		 "#define IMAGE_PX %d.0\n"
		 "#define APRON_PX %d.0\n"
		 "#define TILE_PX %d.0\n"
		 "#define ATLAS_PX %d.0\n"
		 "#define OWN_SHARE 0.05\n"
		 "#define DOUBT 20.0\n", /* of an image that says other than the patch itself */
		 faces, TILES_FACES_ACROSS, (int)tiles->face_rows, SAMPLE_IMAGE_PX, SAMPLE_APRON_PX,
		 SAMPLE_TILE_PX, tiles->atlas_px);
}

static const char *const attributes[] = { "a_position", "a_normal", "a_colour", NULL };

static int init_plain(struct surface_program *p, const char *dissolve)
{
	const struct gl_program_source source = {
		.name = "patches",
		.vertex = (const char *const[]){ light_glsl, vertex_common, plain_vertex, NULL },
		.fragment = (const char *const[]){ "precision mediump float;\n", dissolve,
						   plain_fragment, NULL },
		.attributes = attributes,
	};
	int rc = gl_program_build(&p->program, &source);
	if (rc == 0)
		find_uniforms(p);
	return rc;
}

static int init_blended(struct surface_program *p, const struct tiles *tiles, int faces,
			const char *dissolve)
{
	char constants[512];
	set_constants(constants, sizeof(constants), tiles, faces);
	const struct gl_program_source source = {
		.name = "lumigraph",
		.vertex = (const char *const[]){ constants, light_glsl, vertex_common,
						 blended_vertex, NULL },
		.fragment = (const char *const[]){ constants, dissolve, blended_fragment, NULL },
		.attributes = attributes,
	};
	int rc = gl_program_build(&p->program, &source);
	if (rc < 0)
		return rc;
	find_uniforms(p);
	glUseProgram(p->program);
	glUniform1i(glGetUniformLocation(p->program, "u_tiles"), 0);
	glUniform1i(glGetUniformLocation(p->program, "u_cells"), 1);
	glUniform1i(glGetUniformLocation(p->program, "u_depths"), 2);
	return 0;
}

int surface_init(struct surface *surface, const struct tiles *tiles)
{
	memset(surface, 0, sizeof(*surface));
	int rc = 0;
	for (int i = 0; i < SURFACE_PROGRAMS && rc == 0; i++) {
		const int faces = surface_faces(i);
		const char *dissolve = i == faces ? dissolve_none : dissolve_some;
		rc = faces == 0 ? init_plain(&surface->of[i], dissolve)
				: init_blended(&surface->of[i], tiles, faces, dissolve);
	}
	if (rc < 0)
		surface_finish(surface);
	return rc;
}

void surface_finish(struct surface *surface)
{
	for (int i = 0; i < SURFACE_PROGRAMS; i++)
		if (surface->of[i].program)
			glDeleteProgram(surface->of[i].program);
	memset(surface, 0, sizeof(*surface));
}

void surface_begin(const struct surface *surface, const struct surface_frame *frame, int program)
{
	const struct surface_program *p = &surface->of[program];
	const struct lattice *lattice = &frame->root->lattice;
	const float *eye = frame->view->eye_m, *sun = frame->root->sun;
	glUseProgram(p->program);
	glUniformMatrix4fv(p->clip, 1, GL_FALSE, frame->view->clip);
	glUniform4f(p->lattice, (float)(lattice->origin_m[0] - eye[0]),
		    (float)(lattice->origin_m[1] - eye[1]), (float)(lattice->origin_m[2] - eye[2]),
		    (float)lattice->step_m);
	glUniform4f(p->sun, sun[0], sun[1], sun[2], frame->root->lit ? 1 : 0);
	glUniform1f(p->share, frame->shares ? 1 : 0);
	for (GLuint i = 0; i < 3; i++)
		glEnableVertexAttribArray(i);
	if (surface_faces(program) == 0)
		return;
	const struct plan_tuning *t = &plan_tuning;
	const float facing = 1 / (t->facing_high - t->facing_low);
	const float tune[8] = { t->blur, t->parallax, t->angle, 0, t->facing_low, facing };
	glUniform4fv(p->tune, 2, tune);
	glUniform1f(p->far_m, frame->depth->far_limit_m);
	gl_bind_texture(0, frame->tiles->atlas);
	gl_bind_texture(1, frame->tiles->indirection);
	gl_bind_texture(2, frame->depth->atlas);
}

static int slot_of(const struct surface_frame *frame, const struct blend *blend)
{
	int slot = blend->weight > 0 ? tiles_face_slot(frame->tiles, blend->face) : -1;
	return slot >= 0 && depth_ready(frame->depth, slot, blend->face) ? slot : -1;
}

int surface_choose(const struct surface_frame *frame, const struct blend blend[PLAN_ENTRIES],
		   struct dissolve_range range)
{
	int faces = 0;
	if (!dissolve_draws(range))
		return -1;
	for (int i = 0; i < PLAN_ENTRIES && frame->tiles; i++)
		faces += slot_of(frame, &blend[i]) >= 0;
	return dissolve_is_whole(range) ? faces : faces + PLAN_ENTRIES + 1;
}

int surface_faces(int program)
{
	return program % (PLAN_ENTRIES + 1);
}

void surface_dissolve(const struct surface *surface, int program, struct dissolve_range range)
{
	const struct surface_program *p = &surface->of[program];
	if (p->range >= 0)
		glUniform2f(p->range, range.low, range.high);
}

static void set_face(float rows[20], const struct repository *repository, const struct blend *blend,
		     const float eye_m[3])
{
	const struct cube_axes *axes = &cube_axes[blend->face % CUBE_FACES];
	const float *axis[3] = { axes->right, axes->up, axes->forward };
	float sample[3];
	repository_point_m(repository, blend->face / CUBE_FACES, sample);
	for (int i = 0; i < 3; i++)
		sample[i] -= eye_m[i];
	for (int r = 0; r < 3; r++) {
		for (int i = 0; i < 3; i++) {
			rows[4 * r + i] = axis[r][i];
			rows[4 * r + 3] -= axis[r][i] * sample[i];
		}
	}
	for (int i = 0; i < 3; i++)
		rows[12 + i] = sample[i];
	rows[15] = blend->weight;
	rows[16] = blend->half_px;
}

/* From a place of the face (-1..1, y down) to one in the atlas of depths. */
static void place_window(float out[4], const struct depth *depth, int slot)
{
	const float *window = depth->face[slot].window;
	const float middle[2] = { window[0], -window[1] };
	const float grid[2] = { TILES_FACES_ACROSS,
				(float)depth->atlas_height_px / (float)depth->face_px };
	const float corner[2] = { (float)(slot % TILES_FACES_ACROSS),
				  (float)(slot / TILES_FACES_ACROSS) };
	for (int k = 0; k < 2; k++) {
		/* A hair less, so that the face's rim is not its neighbour's. */
		out[k] = 0.4999f / window[2 + k] / grid[k];
		out[2 + k] = (corner[k] + 0.5f) / grid[k] - middle[k] * out[k];
	}
}

void surface_blend(const struct surface *surface, const struct surface_frame *frame, int program,
		   const struct blend blend[PLAN_ENTRIES], float error_m, float spacing_m)
{
	const struct surface_program *p = &surface->of[program];
	const int faces = surface_faces(program);
	float rows[20 * PLAN_ENTRIES] = { 0 }, slots[4 * PLAN_ENTRIES] = { 0 };
	float windows[4 * PLAN_ENTRIES];
	int at = 0;
	for (int i = 0; i < PLAN_ENTRIES; i++) {
		int slot = slot_of(frame, &blend[i]);
		if (slot < 0)
			continue;
		set_face(&rows[20 * at], frame->repository, &blend[i], frame->view->eye_m);
		slots[4 * at] = (float)(slot % TILES_FACES_ACROSS);
		slots[4 * at + 1] = (float)(slot / TILES_FACES_ACROSS);
		place_window(&windows[4 * at], frame->depth, slot);
		at++;
	}
	glUniform4fv(p->face, 5 * faces, rows);
	glUniform4fv(p->slot, faces, slots);
	glUniform4fv(p->window, faces, windows);
	glUniform4f(p->eye, frame->view->focal_px, error_m, frame->even ? 1 : 0,
		    plan_tuning.own * spacing_m);
	glUniform1f(p->slack, depth_slack_m(frame->depth) + 0.15f * error_m);
}
