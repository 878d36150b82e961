/* Holds the GLSL of the surface programs, builds them per number of faces and tools, and sets their
 * uniforms. */
#include "render/lumigraph/surface.h"

#include <stdio.h>
#include <string.h>

#include "geometry/appearance.h"
#include "geometry/light.h"
#include "geometry/noise.h"
#include "geometry/substance.h"
#include "geometry/vec.h"
#include "render/lumigraph/aim.h"
#include "render/plan/plan_quality.h"

enum { DEPTH_UNIT = 2 }; /* first of the units for depths, one for each face of a piece */

/* Positions are in metres relative to the eye, so that floats suffice anywhere in the model. */
const char surface_vertex_glsl[] =
	"invariant gl_Position;\n" /* the mark is drawn over it at equal depth */
	"attribute vec3 a_position, a_base;\n"
	"attribute vec2 a_normal;\n"
	"attribute vec4 a_colour;\n"
	"uniform mat4 u_clip;\n"
	"uniform vec4 u_lattice;\n" /* origin relative to the eye; step */
	"uniform vec4 u_sun;\n"     /* direction; 1 where the model is lit */
	"varying vec4 v_colour;\n"  /* a: weight of the patch's own colour among the images */
	"#ifdef CUT\n"
	"uniform vec4 u_cut;\n"
	"varying float v_cut;\n" /* metres in front of the section plane */
	"#endif\n"
	"#ifdef CUT_SOLID\n"
	"varying vec3 v_from;\n" /* metres from the eye */
	"#endif\n"
	"#ifdef RAKE\n"
	"varying vec4 v_rake;\n"
	"#endif\n"
	"#ifdef FOG\n"
	"uniform float u_far;\n" /* 1 / range */
	"varying vec3 v_away;\n" /* from the eye; 1 is the range */
	"#endif\n"
	"void use_tools(vec3 p, vec3 n) {\n"
	"#ifdef FOG\n"
	"	v_away = p * u_far;\n"
	"#endif\n"
	"#ifdef CUT\n"
	"	v_cut = dot(u_cut.xyz, p) - u_cut.w;\n"
	"#endif\n"
	"#ifdef CUT_SOLID\n"
	"	v_from = p;\n"
	"#endif\n"
	"#ifdef RAKE\n"
	"	v_rake = rake_of(n, a_colour.a, u_sun);\n"
	"#endif\n"
	"}\n"
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

static const char plain_vertex[] =
	"void main() {\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * (a_base + a_position);\n"
	"	vec3 n = unit_normal();\n"
	"	v_colour = vec4(own_colour(n), 1.0);\n"
	"	use_tools(p, n);\n"
	"	gl_Position = u_clip * vec4(p, 1.0);\n"
	"}\n";

/* Visible back faces are where the plane cuts solid matter: the substance that the content
 * names, where the ray met the plane; or one flat colour, as in a section drawing. In programs that
 * look up textures, fragments that are cut away or dissolved are discarded last. */
const char surface_tools_glsl[] =
	"#ifdef RAKE\n"
	"uniform vec3 u_rake;\n"
	"varying vec4 v_rake;\n"
	"#endif\n"
	"#ifdef CUT\n"
	"varying float v_cut;\n"
	"#endif\n"
	"#ifdef CUT_SOLID\n"
	"uniform vec4 u_stand;\n"  /* the eye; u_cut.w */
	"uniform float u_grain;\n" /* size of a pixel at a metre */
	"varying vec3 v_from;\n"
	/* the colour where the ray meets the plane, if it does so before the surface */
	"vec3 cut_colour() {\n"
	"	float share = u_stand.w / (v_cut + u_stand.w);\n"
	"	vec3 p = share > 0.0 && share < 1.0 ? v_from * share : v_from;\n"
	"	float size = length(p) * u_grain;\n"
	"	p += u_stand.xyz;\n"
	"	return CUT_SOLID(p.x, p.y, p.z, size);\n"
	"}\n"
	"#else\n"
	"vec3 cut_colour() {\n"
	"	return vec3(0.62, 0.28, 0.15);\n" /* the laterite colour of the theme */
	"}\n"
	"#endif\n"
	"#ifdef FOG\n"
	"uniform vec4 u_fog;\n" /* colour; how much of it is seen */
	"uniform float u_thick;\n"
	"varying vec3 v_away;\n"
	"#endif\n"
	"vec3 lit_by_tools(vec3 colour) {\n"
	"#ifdef RAKE\n"
	"	colour = min(colour * rake_light(v_rake, u_rake), 1.0);\n"
	"#endif\n"
	"#ifdef CUT\n"
	"	if (!gl_FrontFacing)\n"
	"		colour = cut_colour();\n"
	"#endif\n"
	"#ifdef FOG\n"
	"	float fog = fog_share(length(v_away), u_thick > 0.5);\n"
	"	colour = mix(colour, u_fog.rgb, fog * u_fog.a);\n"
	"#endif\n"
	"	return colour;\n"
	"}\n"
	"void cut_away() {\n"
	"#ifdef CUT\n"
	"	if (v_cut > 0.0)\n"
	"		discard;\n"
	"#endif\n"
	"}\n";

/* A fixed number for each pixel, evenly distributed over any few neighbours: interleaved gradient
 * noise (Jimenez 2014, "Next generation post processing in Call of Duty: Advanced Warfare"). */
const char surface_whole_glsl[] = "void dissolve() {}\n";
const char surface_dissolve_glsl[] =
	"#ifdef GL_FRAGMENT_PRECISION_HIGH\n"
	"#define NUMBER highp\n"
	"#define PIXEL gl_FragCoord.xy\n"
	"#else\n"
	"#define NUMBER mediump\n"
	/* mediump loses the digits of larger numbers */
	"#define PIXEL mod(floor(gl_FragCoord.xy), 32.0)\n"
	"#endif\n"
	"uniform NUMBER vec2 u_range;\n"
	"void dissolve() {\n"
	"	NUMBER float u = fract(52.9829189 * fract(dot(PIXEL, vec2(0.06711056,\n"
	"								  0.00583715))));\n"
	"	if (u < u_range.x || u >= u_range.y)\n"
	"		discard;\n"
	"}\n";

const char surface_plain_glsl[] =
	"varying vec4 v_colour;\n"
	"uniform float u_share;\n"
	"void main() {\n"
	"	dissolve();\n"
	"	cut_away();\n"
	"	gl_FragColor = vec4(lit_by_tools(v_colour.rgb) * (1.0 - u_share),"
	"			    1.0);\n"
	"}\n";

/* Five rows per face: three of the aim; the sampling point and the blend's weight; (half_px, the
 * aim's depth, 0, 0). quality() computes the same as plan_quality. */
static const char blended_vertex[] =
	"uniform vec4 u_face[5 * FACES];\n"
	"uniform vec4 u_eye;\n"     /* focal_px, error_m, even, spacing times own penalty */
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
	"vec4 seen(vec3 p, vec3 n, vec4 r, vec4 u, vec4 f, vec4 s, vec2 size) {\n"
	"	if (s.w <= 0.0)\n"
	"		return vec4(0.0, 0.0, 1.0, 0.0);\n"
	"	vec3 q = vec3(dot(r.xyz, p) + r.w, dot(u.xyz, p) + u.w, dot(f.xyz, p) + f.w);\n"
	"	float k = u_eye.z < 0.5 ? quality(p, n, s.xyz, max(q.z + size.y, 1e-5), size.x) : 1.0;\n"
	"	return vec4(q, s.w * k);\n"
	"}\n"
	"float sharpen(float k) { return k * k * k * k; }\n"
	"void main() {\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * (a_base + a_position);\n"
	"	vec3 n = unit_normal();\n"
	"	float most = 0.0;\n"
	"	for (int i = 0; i < FACES; i++) {\n"
	"		v_face[i] = seen(p, n, u_face[5 * i], u_face[5 * i + 1], u_face[5 * i + 2],\n"
	"				 u_face[5 * i + 3], u_face[5 * i + 4].xy);\n"
	"		most = max(most, v_face[i].w);\n"
	"	}\n"
	"	float own = 1.0 + u_eye.w * u_eye.x / length(p);\n"
	"	own = u_eye.z < 0.5 ? 1.0 / (own * own) : 0.01;\n"
	"	most = max(most, own);\n"
	"	for (int i = 0; i < FACES; i++)\n"
	"		v_face[i].w = sharpen(v_face[i].w / most);\n"
	"	use_tools(p, n);\n"
	"	v_colour = vec4(own_colour(n), OWN_SHARE * sharpen(own / most) + 0.0005);\n"
	"	gl_Position = u_clip * vec4(p, 1.0);\n"
	"}\n";

/* Constants shared by C and GLSL are prepended (set_constants). Cells and depths are relative to
 * those of the aim, which are integers, so all of it works in mediump
 * (tests/render/lumigraph/test_mediump.c). */
static const char blended_fragment[] =
	"uniform sampler2D u_tiles;\n"
	"uniform FINE sampler2D u_cells, u_depths[FACES];\n" /* the default is lowp */
	"uniform vec4 u_place[FACES];\n"  /* the aim's cell; the face's first cell in the texture */
	"uniform vec4 u_window[FACES];\n" /* from cells to the depth sheet: scale, offset */
	"uniform vec3 u_base[FACES];\n"   /* the aim's depth in metres; and in units, as 64 x + y */
	"uniform vec2 u_depth;\n"         /* metres per unit; the nearest depth */
	"uniform float u_share, u_slack;\n"
	"varying vec4 v_colour;\n"
	"varying vec4 v_face[FACES];\n"
	"vec4 from_face(FINE sampler2D depths, vec4 face, vec4 place, vec4 window, vec3 base) {\n"
	"	float z = face.z + base.x;\n"
	"	if (face.w < 0.0005 || z < u_depth.y)\n"
	"		return vec4(0.0);\n"
	"	vec2 way = face.xy / z;\n"
	"	vec2 cell = place.xy + floor(way);\n"
	"	vec2 outside = abs(cell - (CELLS - 1.0) / 2.0);\n"
	"	if (max(outside.x, outside.y) > CELLS / 2.0)\n"
	"		return vec4(0.0);\n"
	"	vec3 d = texture2D(depths, way * window.xy + window.zw).rgb;\n"
	/* 5, 6, 5 bits; some drivers keep 8 */
	"	d = floor(d * vec3(31.0, 63.0, 31.0) + 0.5);\n"
	"	d.xy -= base.yz;\n"
	"	float behind = face.z - dot(d, vec3(64.0, 1.0, 1.0 / 32.0)) * u_depth.x;\n"
	"	float slack = u_slack + 0.001 * z;\n"
	"	float w = face.w * clamp(2.0 - behind / slack, 0.0, 1.0);\n"
	"	if (w < 0.0002)\n"
	"		return vec4(0.0);\n"
	"	vec4 tile = texture2D(u_cells, (place.zw + cell) / CELL_GRID) * 255.0;\n"
	/* share of the tile that a cell covers */
	"	float share = floor(tile.b + 0.5) / CELLS;\n"
	"	vec2 local = way * share + (place.xy * share - floor((cell + 0.5) * share));\n"
	"	vec2 at = floor(tile.rg + 0.5 - MIDDLE) * IMAGE + (local * TILE + APRON);\n"
	"	w *= tile.a / 255.0;\n"
	"	vec3 colour = texture2D(u_tiles, at).rgb;\n"
	"	vec3 off = colour - v_colour.rgb;\n"
	"	w /= 1.0 + DOUBT * dot(off, off);\n"
	"	return vec4(colour * w, w);\n"
	"}\n"
	"void main() {\n"
	"	vec4 sum = vec4(0.0);\n"
	"	for (int i = 0; i < FACES; i++)\n"
	"		sum += from_face(u_depths[i], v_face[i], u_place[i], u_window[i],\n"
	"				 u_base[i]);\n"
	"	float own = v_colour.a;\n"
	"	vec3 colour = (sum.rgb + own * v_colour.rgb) / (sum.a + own);\n"
	"	float share = sum.a / (sum.a + own);\n"
	"	gl_FragColor = vec4(mix(lit_by_tools(colour), vec3(share), u_share), 1.0);\n"
	"	cut_away();\n"
	"	dissolve();\n" /* last: SwiftShader reads textures wrongly after a discard */
	"}\n";

static void find_uniforms(struct surface_program *p)
{
	p->clip = glGetUniformLocation(p->program, "u_clip");
	p->lattice = glGetUniformLocation(p->program, "u_lattice");
	p->sun = glGetUniformLocation(p->program, "u_sun");
	p->eye = glGetUniformLocation(p->program, "u_eye");
	p->face = glGetUniformLocation(p->program, "u_face");
	p->place = glGetUniformLocation(p->program, "u_place");
	p->window = glGetUniformLocation(p->program, "u_window");
	p->base = glGetUniformLocation(p->program, "u_base");
	p->tune = glGetUniformLocation(p->program, "u_tune");
	p->share = glGetUniformLocation(p->program, "u_share");
	p->depth = glGetUniformLocation(p->program, "u_depth");
	p->slack = glGetUniformLocation(p->program, "u_slack");
	p->range = glGetUniformLocation(p->program, "u_range");
	surface_find_tools(&p->tools, p->program);
}

static void set_constants(char *out, size_t bytes, const struct tiles *tiles, int faces)
{
	char of_tiles[TILES_CONSTANTS_BYTES];
	tiles_constants(of_tiles, tiles);
	snprintf(out, bytes,
		 "%s#define FACES %d\n"
		 "#define OWN_SHARE 0.05\n"
		 /* penalty for an image that differs from the patch's own colour */
		 "#define DOUBT 20.0\n",
		 of_tiles, faces);
}

const char *const surface_attributes[] = { "a_position", "a_normal", "a_colour", "a_base", NULL };

/* The limit of uniforms has no room for a substance beside fog and the raking light. */
static bool cuts_substance(unsigned tools, unsigned cut)
{
	const unsigned full = SURFACE_RAKE | SURFACE_FOG;

	return cut > 0 && (tools & SURFACE_CUT) && (tools & full) != full && gl_has_highp();
}

void surface_define(char *out, unsigned tools, unsigned cut)
{
	char substance[50] = "";

	if (cuts_substance(tools, cut))
		snprintf(substance, sizeof(substance), "#define CUT_SOLID %s_colour\n",
			 substance_names[cut]);
	snprintf(out, SURFACE_DEFINES_BYTES, "%s%s%s%s",
		 tools & SURFACE_RAKE ? "#define RAKE\n" : "",
		 tools & SURFACE_CUT ? "#define CUT\n" : "",
		 tools & SURFACE_FOG ? "#define FOG\n" : "", substance);
}

struct surface_cut_glsl surface_cut_glsl(unsigned tools, unsigned cut)
{
	if (!cuts_substance(tools, cut))
		return (struct surface_cut_glsl){ "", "", false };
	return (struct surface_cut_glsl){ noise_glsl, substance_glsl, true };
}

static const char coarse[] = "precision mediump float;\n";

static int init_plain(struct surface_program *p, unsigned tools, unsigned cut, const char *dissolve)
{
	const struct surface_cut_glsl solid = surface_cut_glsl(tools, cut);
	const char *vertex = "", *fragment = "";
	char defines[SURFACE_DEFINES_BYTES];
	surface_define(defines, tools, cut);
	if (tools & SURFACE_RAKE) {
		vertex = rake_vertex_glsl;
		fragment = rake_fragment_glsl;
	}
	const struct gl_program_source source = {
		.name = "patches",
		.vertex = (const char *const[]){ defines, light_glsl, vertex, surface_vertex_glsl,
						 plain_vertex, NULL },
		.fragment = (const char *const[]){ solid.needs_highp ? gl_fine_fragment : coarse,
						   defines, fragment, appearance_fog_glsl,
						   solid.noise, solid.substance, surface_tools_glsl,
						   dissolve, surface_plain_glsl, NULL },
		.attributes = surface_attributes,
	};
	int rc = gl_program_build(&p->program, &source);
	if (rc == 0)
		find_uniforms(p);
	return rc;
}

static int init_blended(struct surface_program *p, const struct tiles *tiles, int faces,
			unsigned tools, unsigned cut, const char *dissolve)
{
	const struct surface_cut_glsl solid = surface_cut_glsl(tools, cut);
	const char *vertex = "", *fragment = "";
	char defines[SURFACE_DEFINES_BYTES];
	char constants[512];
	if (tools & SURFACE_RAKE) {
		vertex = rake_vertex_glsl;
		fragment = rake_fragment_glsl;
	}
	surface_define(defines, tools, cut);
	set_constants(constants, sizeof(constants), tiles, faces);
	const struct gl_program_source source = {
		.name = "lumigraph",
		.vertex = (const char *const[]){ defines, constants, light_glsl, vertex,
						 surface_vertex_glsl, blended_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, defines, constants, fragment,
						   appearance_fog_glsl, solid.noise,
						   solid.substance, surface_tools_glsl, dissolve,
						   blended_fragment, NULL },
		.attributes = surface_attributes,
	};
	int rc = gl_program_build(&p->program, &source);
	if (rc < 0)
		return rc;
	find_uniforms(p);
	glUseProgram(p->program);
	glUniform1i(glGetUniformLocation(p->program, "u_tiles"), 0);
	glUniform1i(glGetUniformLocation(p->program, "u_cells"), 1);
	static const GLint units[PLAN_ENTRIES] = { DEPTH_UNIT, DEPTH_UNIT + 1, DEPTH_UNIT + 2,
						   DEPTH_UNIT + 3 };
	glUniform1iv(glGetUniformLocation(p->program, "u_depths"), faces, units);
	return 0;
}

static int init_program(struct surface *surface, unsigned tools, int program)
{
	struct surface_program *p = &surface->of[tools][program];
	const int faces = surface_faces(program);
	const char *dissolve = program == faces ? surface_whole_glsl : surface_dissolve_glsl;
	return faces == 0 ? init_plain(p, tools, surface->cut, dissolve)
			  : init_blended(p, surface->tiles, faces, tools, surface->cut, dissolve);
}

int surface_init(struct surface *surface, const struct tiles *tiles)
{
	memset(surface, 0, sizeof(*surface));
	surface->tiles = tiles;
	int rc = 0;
	for (int i = 0; i < SURFACE_PROGRAMS && rc == 0; i++)
		rc = init_program(surface, 0, i);
	if (rc < 0)
		surface_finish(surface);
	return rc;
}

void surface_finish(struct surface *surface)
{
	for (int tools = 0; tools < SURFACE_TOOLS; tools++)
		for (int i = 0; i < SURFACE_PROGRAMS; i++)
			if (surface->of[tools][i].program)
				glDeleteProgram(surface->of[tools][i].program);
	memset(surface, 0, sizeof(*surface));
}

unsigned surface_tools(const struct surface_frame *frame)
{
	return (frame->rake.on && !frame->shares ? SURFACE_RAKE : 0u) |
	       (view_is_cut(frame->view) ? SURFACE_CUT : 0u) |
	       (frame->fog.share > 0 && !frame->shares ? SURFACE_FOG : 0u);
}

void surface_find_tools(struct surface_tool_uniforms *out, GLuint program)
{
	out->rake = glGetUniformLocation(program, "u_rake");
	out->cut = glGetUniformLocation(program, "u_cut");
	out->far = glGetUniformLocation(program, "u_far");
	out->fog = glGetUniformLocation(program, "u_fog");
	out->thick = glGetUniformLocation(program, "u_thick");
	out->stand = glGetUniformLocation(program, "u_stand");
	out->pixel = glGetUniformLocation(program, "u_grain");
}

void surface_set_tools(const struct surface_tool_uniforms *at, const struct surface_frame *frame)
{
	const struct surface_fog *fog = &frame->fog;
	float towards[3];

	if (at->rake >= 0) {
		rake_direction(&frame->rake, frame->view->right, frame->view->up,
			       frame->view->forward, towards);
		glUniform3fv(at->rake, 1, towards);
	}
	if (at->cut >= 0)
		glUniform4fv(at->cut, 1, frame->view->cut);
	if (at->stand >= 0) {
		const float *eye = frame->view->eye_m;

		glUniform4f(at->stand, eye[0], eye[1], eye[2], frame->view->cut[3]);
		glUniform1f(at->pixel, 1 / frame->view->focal_px);
	}
	if (at->fog >= 0) {
		glUniform1f(at->far, 1 / fog->range_m);
		glUniform1f(at->thick, fog->is_exponential ? 1 : 0);
		glUniform4f(at->fog, fog->rgb[0], fog->rgb[1], fog->rgb[2], fog->share);
	}
}

/* Deletes the programs of another release's cut face. */
static void change_cut(struct surface *surface, uint8_t cut)
{
	for (int tools = 0; tools < SURFACE_TOOLS; tools++) {
		if (!(tools & SURFACE_CUT))
			continue;
		for (int i = 0; i < SURFACE_PROGRAMS; i++) {
			if (surface->of[tools][i].program)
				glDeleteProgram(surface->of[tools][i].program);
			surface->of[tools][i] = (struct surface_program){ 0 };
		}
		surface->lacks[tools] = false;
	}
	surface->cut = cut;
}

/* Returns the program with the active tools; builds it where it is missing. */
static struct surface_program *use(struct surface *surface, const struct surface_frame *frame,
				   int program)
{
	const unsigned tools = surface_tools(frame);
	if (surface->cut != frame->root->cut)
		change_cut(surface, frame->root->cut);
	if (!surface->of[tools][program].program && !surface->lacks[tools])
		surface->lacks[tools] = init_program(surface, tools, program) < 0;
	return &surface->of[surface->lacks[tools] ? 0 : tools][program];
}

bool surface_is_new(const struct surface *surface, const struct surface_frame *frame, int program)
{
	const unsigned tools = surface_tools(frame);
	const struct surface_program *p = &surface->of[surface->lacks[tools] ? 0 : tools][program];
	return !p->program || !p->is_drawn[frame->is_direct];
}

bool surface_prepare(struct surface *surface, const struct surface_frame *frame)
{
	const unsigned tools = surface_tools(frame);
	for (int i = 0; i < SURFACE_PROGRAMS && !surface->lacks[tools]; i++)
		if (!surface->of[tools][i].program) {
			(void)use(surface, frame, i);
			return false;
		}
	return true;
}

void surface_begin(struct surface *surface, const struct surface_frame *frame, int program)
{
	struct surface_program *p = use(surface, frame, program);
	const struct lattice *lattice = &frame->root->lattice;
	const float *eye = frame->view->eye_m, *sun = frame->root->sun;
	surface->used = p;
	p->is_drawn[frame->is_direct] = true;
	glUseProgram(p->program);
	glUniformMatrix4fv(p->clip, 1, GL_FALSE, frame->view->clip);
	glUniform4f(p->lattice, (float)(lattice->origin_m[0] - eye[0]),
		    (float)(lattice->origin_m[1] - eye[1]), (float)(lattice->origin_m[2] - eye[2]),
		    (float)lattice->step_m);
	glUniform4f(p->sun, sun[0], sun[1], sun[2], frame->root->lit ? 1 : 0);
	glUniform1f(p->share, frame->shares ? 1 : 0);
	surface_set_tools(&p->tools, frame);
	for (GLuint i = 0; i < 3; i++)
		glEnableVertexAttribArray(i);
	if (surface_faces(program) == 0)
		return;
	const struct plan_tuning *t = &plan_tuning;
	const float facing = 1 / (t->facing_high - t->facing_low);
	const float tune[8] = { t->blur, t->parallax, t->angle, 0, t->facing_low, facing };
	glUniform4fv(p->tune, 2, tune);
	glUniform2f(p->depth, aim_unit_m(frame->depth->far_limit_m),
		    0.0004f * frame->depth->far_limit_m);
	gl_bind_texture(0, frame->tiles->atlas);
	gl_bind_texture(1, frame->tiles->indirection);
	for (int i = 0; i < surface_faces(program); i++)
		gl_bind_texture(DEPTH_UNIT + (unsigned)i, frame->depth->sheet[0]);
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
	for (int i = 0; i < PLAN_ENTRIES && frame->tiles && faces < frame->faces; i++)
		faces += slot_of(frame, &blend[i]) >= 0;
	return dissolve_is_whole(range) ? faces : faces + PLAN_ENTRIES + 1;
}

int surface_faces(int program)
{
	return program % (PLAN_ENTRIES + 1);
}

void surface_dissolve(const struct surface *surface, struct dissolve_range range)
{
	const struct surface_program *p = surface->used;
	if (p->range >= 0)
		glUniform2f(p->range, range.low, range.high);
}

/* Computes the mapping from the aim's cells to the depth sheet. */
static void place_window(float out[4], const struct depth *depth, int slot, const struct aim *aim)
{
	const float *window = depth->face[slot].window;
	const float middle[2] = { window[0], -window[1] };
	const struct depth_place place = depth_place(depth, slot);
	const float grid[2] = { (float)depth->layout.across, (float)depth->layout.rows };
	const float corner[2] = { (float)place.column, (float)place.row };
	const float half = AIM_CELLS / 2;
	for (int k = 0; k < 2; k++) {
		/* Slightly less, so that the border of the face does not read its neighbour's
		 * texels. */
		float scale = 0.4999f / window[2 + k] / grid[k];
		float from = (aim->cell[k] - half) / half - middle[k];
		out[k] = scale / half;
		out[2 + k] = (corner[k] + 0.5f) / grid[k] + from * scale;
		if (depth->repeats && 2 * corner[k] >= grid[k])
			out[2 + k] -= 1;
	}
}

/* The uniforms of the faces, one after the other. */
struct told {
	float face[PLAN_ENTRIES][20], place[PLAN_ENTRIES][4], window[PLAN_ENTRIES][4];
	float base[PLAN_ENTRIES][3];
};

static void tell(struct told *told, int at, const struct surface_frame *frame,
		 const struct blend *blend, int slot, const struct piece *piece)
{
	const struct tiles *tiles = frame->tiles;
	float point[3], centre[3], *row = told->face[at];
	struct aim aim;
	repository_point_m(frame->repository, blend->face / CUBE_FACES, point);
	vec_sub(point, point, frame->view->eye_m);
	vec_sub(centre, piece->centre_m, frame->view->eye_m);
	aim_at(&aim, &cube_axes[blend->face % CUBE_FACES], point, centre, piece->radius_m,
	       frame->depth->far_limit_m);
	memcpy(row, aim.rows, sizeof(aim.rows));
	memcpy(&row[12], point, sizeof(point));
	row[15] = blend->weight;
	row[16] = blend->half_px;
	row[17] = aim.depth_m;
	told->place[at][0] = aim.cell[0];
	told->place[at][1] = aim.cell[1];
	told->place[at][2] = (float)(slot % (int)tiles->faces_across * TILES_CELLS) + 0.5f;
	told->place[at][3] = (float)(slot / (int)tiles->faces_across * TILES_CELLS) + 0.5f;
	place_window(told->window[at], frame->depth, slot, &aim);
	if (frame->depth->layout.sheets > 1)
		gl_bind_texture(DEPTH_UNIT + (unsigned)at,
				frame->depth->sheet[depth_place(frame->depth, slot).sheet]);
	told->base[at][0] = aim.depth_m;
	told->base[at][1] = floorf(aim.units / 64);
	told->base[at][2] = aim.units - 64 * told->base[at][1];
}

/* Returns the heaviest of the blends that have a slot, or -1. */
static int heaviest(const struct blend blend[PLAN_ENTRIES], const int slot[PLAN_ENTRIES])
{
	int at = -1;
	for (int i = 0; i < PLAN_ENTRIES; i++)
		if (slot[i] >= 0 && (at < 0 || blend[i].weight > blend[at].weight))
			at = i;
	return at;
}

void surface_blend(const struct surface *surface, const struct surface_frame *frame, int program,
		   const struct blend blend[PLAN_ENTRIES], const struct piece *piece, float error_m)
{
	const struct surface_program *p = surface->used;
	const int faces = surface_faces(program);
	struct told told = { 0 };
	int slot[PLAN_ENTRIES];
	for (int i = 0; i < PLAN_ENTRIES; i++)
		slot[i] = slot_of(frame, &blend[i]);
	for (int at = 0; at < faces; at++) {
		const int i = heaviest(blend, slot);
		if (i < 0)
			break;
		tell(&told, at, frame, &blend[i], slot[i], piece);
		slot[i] = -1;
	}
	glUniform4fv(p->face, 5 * faces, told.face[0]);
	glUniform4fv(p->place, faces, told.place[0]);
	glUniform4fv(p->window, faces, told.window[0]);
	glUniform3fv(p->base, faces, told.base[0]);
	glUniform4f(p->eye, frame->view->focal_px, error_m, frame->even ? 1 : 0,
		    plan_tuning.own * piece->spacing_m);
	glUniform1f(p->slack, depth_slack_m(frame->depth) + 0.15f * error_m);
}
