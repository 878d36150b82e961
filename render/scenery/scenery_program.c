/* Holds the GLSL of scenery and builds it by features. */
#include "render/scenery/scenery_program.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/compiler.h"
#include "geometry/appearance.h"
#include "geometry/light.h"
#include "geometry/noise.h"
#include "geometry/substance.h"

/* Where the light is computed, in the vertex or in the fragment shader; each uniform is in one of
 * them only, because their precisions differ. */
static const char shade[] =
	"#ifdef GLOSSY\n"
	"uniform vec4 u_specular;\n" /* colour, exponent */
	"uniform vec3 u_emissive;\n"
	"#endif\n"
	"#if defined(SOLID) || defined(RELIEF)\n"
	"uniform float u_pixel;\n" /* its size at a metre */
	"varying vec3 v_solid;\n"
	"#endif\n"
	"#ifdef RELIEF\n"
	"#define PLACES 4\n"
	"#else\n"
	"#define PLACES 1\n"
	"#endif\n"
	"#ifdef SOLID\n"
	"uniform vec3 u_tint;\n"
	"#endif\n"
	"#ifdef RELIEF\n"
	"uniform mat3 u_slope;\n"
	"uniform float u_relief;\n"
	"#endif\n"
	"#ifdef MIRROR\n"
	"uniform samplerCube u_around;\n"
	"uniform float u_mirror;\n"
	"#endif\n"
	/* The ways of the picture's right and top are those in which its coordinates grow, by the
	 * neighbouring pixels: exact in a flat triangle. */
	"#ifdef NORMALS\n"
	"uniform sampler2D u_normals;\n"
	"vec3 mapped(vec3 n, vec3 p) {\n"
	"	vec3 across = dFdx(p), down = dFdy(p);\n"
	"	vec2 by_x = dFdx(v_uv), by_y = dFdy(v_uv);\n"
	"	float area = by_x.x * by_y.y - by_y.x * by_x.y < 0.0 ? -1.0 : 1.0;\n"
	"	vec3 right = area * (across * by_y.y - down * by_x.y);\n"
	"	vec3 wanted = area * (across * by_y.x - down * by_x.x);\n"
	"	right -= n * dot(right, n);\n"
	"	right /= max(length(right), 1e-18);\n"
	"	vec3 top = cross(n, right);\n"
	"	vec3 map = texture2D(u_normals, v_uv).rgb * 2.0 - 1.0;\n"
	"	map.xy *= gl_FrontFacing ? 1.0 : -1.0;\n"
	"	map.y *= dot(top, wanted) < 0.0 ? -1.0 : 1.0;\n"
	"	return normalize(map.x * right + map.y * top + map.z * n);\n"
	"}\n"
	"#endif\n"
	"vec3 shaded(vec3 surface, vec3 n, vec3 p, vec4 sun) {\n"
	"	vec3 to_eye = normalize(-p);\n"
	"#if defined(SOLID) || defined(RELIEF)\n"
	"	float size = length(p) * u_pixel;\n"
	"#endif\n"
	"#if defined(SOLID) || defined(RELIEF)\n"
	"	vec3 pattern = vec3(0.0), beside = vec3(0.0);\n"
	/* a loop, because compilers take long for the pattern; the first round is the place itself
	 */
	"	float step = max(size, 0.001);\n"
	"	for (int i = 0; i < PLACES; i++) {\n"
	"		vec3 way = vec3(i == 1, i == 2, i == 3);\n"
	"		vec3 there = pattern_at(v_solid + step * way, size);\n"
	"		if (i == 0)\n"
	"			pattern = there;\n"
	"		beside += way * dot(there, vec3(0.3, 0.6, 0.1));\n"
	"	}\n"
	"#endif\n"
	"#ifdef SOLID\n"
	"	surface *= u_tint * pattern;\n"
	"#endif\n"
	"	float before = sun.w > 0.5 ? 1.0 : light(n, 1.0, sun.xyz);\n"
	"#ifdef NORMALS\n"
	"	n = mapped(n, p);\n"
	"#endif\n"
	"#ifdef RELIEF\n"
	"	vec3 slope = (beside - dot(pattern, vec3(0.3, 0.6, 0.1))) / step;\n"
	"	slope = u_slope * slope;\n"
	"	n = normalize(n - u_relief * (slope - n * dot(slope, n)));\n"
	"#endif\n"
	"	vec3 colour = surface * (light(n, 1.0, sun.xyz) / before);\n"
	"#ifdef GLOSSY\n"
	"	colour += u_emissive;\n"
	"#endif\n"
	"#ifdef MIRROR\n"
	"	colour = mix(colour, textureCube(u_around, reflect(-to_eye, n)).rgb, u_mirror);\n"
	"#endif\n"
	"#ifdef GLOSSY\n"
	"	colour += u_specular.rgb * highlight(n, to_eye, sun.xyz,\n"
	"							  u_specular.a);\n"
	"#endif\n"
	"	return min(colour, 1.0);\n"
	"}\n";

/* Positions are in metres relative to the eye, so that floats suffice anywhere in the model. A back
 * that is seen has the light of its own side. */
static const char vertex[] =
	"uniform mat4 u_model;\n"
	"uniform vec3 u_turned[3];\n" /* columns */
	"uniform float u_sides;\n"
	"#ifdef BY_PIXEL\n"
	"varying vec3 v_normal, v_place;\n"
	"#endif\n"
	"#if defined(SOLID) || defined(RELIEF)\n"
	"uniform mat4 u_solid;\n"
	"varying vec3 v_solid;\n"
	"#endif\n"
	"#ifdef PAINTED\n"
	"uniform vec4 u_uv;\n" /* origin, step */
	"varying vec2 v_uv;\n"
	"#endif\n"
	"void main() {\n"
	"#ifdef PAINTED\n"
	"	v_uv = u_uv.xy + u_uv.zw * a_base.xy;\n"
	"#endif\n"
	"#if defined(SOLID) || defined(RELIEF)\n"
	"	v_solid = (u_solid * vec4(a_position, 1.0)).xyz;\n"
	"#endif\n"
	"	vec3 p = (u_model * vec4(a_position, 1.0)).xyz;\n"
	"	vec3 e = unit_normal();\n"
	"	vec3 n = normalize(u_turned[0] * e.x + u_turned[1] * e.y + u_turned[2] * e.z);\n"
	"#ifdef BY_PIXEL\n"
	"	v_normal = n;\n"
	"	v_place = p;\n"
	"	v_colour = a_colour;\n"
	"#endif\n"
	"	if (u_sides > 0.5 && dot(n, p) > 0.0)\n"
	"		n = -n;\n"
	"#ifndef BY_PIXEL\n"
	"	v_colour = vec4(shaded(a_colour.rgb, n, p, u_sun), 1.0);\n"
	"#endif\n"
	"	use_tools(p, n);\n"
	"	gl_Position = u_clip * vec4(p, 1.0);\n"
	"}\n";

/* What `shade` needs of the fragment. */
static const char painted[] = "#ifdef PAINTED\n"
			      "varying vec2 v_uv;\n"
			      "#endif\n";
static const char derivatives[] = "#extension GL_OES_standard_derivatives : enable\n";

static const char fragment[] =
	/* u_light is u_sun */
	"varying vec4 v_colour;\n"
	"uniform float u_opacity;\n"
	"#ifdef BY_PIXEL\n"
	"uniform vec4 u_light;\n"
	"varying vec3 v_normal, v_place;\n"
	"#endif\n"
	"#ifdef TEXTURE\n"
	"uniform sampler2D u_texture;\n"
	"#endif\n"
	"void main() {\n"
	"	vec3 colour = v_colour.rgb;\n"
	"#ifdef TEXTURE\n"
	"	colour *= texture2D(u_texture, v_uv).rgb;\n"
	"#endif\n"
	"#ifdef BY_PIXEL\n"
	"	vec3 n = normalize(gl_FrontFacing ? v_normal : -v_normal);\n"
	"	colour = shaded(colour, n, v_place, u_light);\n"
	"#endif\n"
	"	gl_FragColor = vec4(lit_by_tools(colour), u_opacity);\n"
	"	cut_away();\n"
	"	dissolve();\n"
	"}\n";

static void find_uniforms(struct scenery_program *p)
{
	p->clip = glGetUniformLocation(p->program, "u_clip");
	p->model = glGetUniformLocation(p->program, "u_model");
	p->normal = glGetUniformLocation(p->program, "u_turned");
	p->sides = glGetUniformLocation(p->program, "u_sides");
	p->sun[0] = glGetUniformLocation(p->program, "u_sun");
	p->sun[1] = glGetUniformLocation(p->program, "u_light");
	p->range = glGetUniformLocation(p->program, "u_range");
	p->specular = glGetUniformLocation(p->program, "u_specular");
	p->emissive = glGetUniformLocation(p->program, "u_emissive");
	p->opacity = glGetUniformLocation(p->program, "u_opacity");
	p->solid = glGetUniformLocation(p->program, "u_solid");
	p->slope = glGetUniformLocation(p->program, "u_slope");
	p->tint = glGetUniformLocation(p->program, "u_tint");
	p->relief = glGetUniformLocation(p->program, "u_relief");
	p->mirror = glGetUniformLocation(p->program, "u_mirror");
	p->pixel = glGetUniformLocation(p->program, "u_pixel");
	p->uv = glGetUniformLocation(p->program, "u_uv");
	surface_find_tools(&p->tools, p->program);
}

/* Writes what the texts ask for. */
static void define(char *out, size_t bytes, unsigned features, unsigned cut)
{
	char tools[SURFACE_DEFINES_BYTES];
	const unsigned kind = features / SCENERY_SUBSTANCE;
	char solid[40] = "";

	if (kind > 0)
		snprintf(solid, sizeof(solid), "#define SOLID %s_colour\n", substance_names[kind]);
	surface_define(tools, features % SURFACE_TOOLS, cut);
	snprintf(out, bytes, "%s%s%s%s%s%s%s%s%s", tools,
		 features & SCENERY_BY_PIXEL ? "#define BY_PIXEL\n" : "",
		 features & SCENERY_GLOSSY ? "#define GLOSSY\n" : "",
		 features & SCENERY_RELIEF ? "#define RELIEF\n" : "",
		 features & SCENERY_MIRROR ? "#define MIRROR\n" : "",
		 features & SCENERY_TEXTURE ? "#define TEXTURE\n" : "",
		 features & SCENERY_NORMALS ? "#define NORMALS\n" : "",
		 features & (SCENERY_TEXTURE | SCENERY_NORMALS) ? "#define PAINTED\n" : "", solid);
}

/* Returns a text if it is needed. */
static const char *where(bool is_needed, const char *text)
{
	return is_needed ? text : "";
}

static int build(struct scenery_program *p, unsigned cut)
{
	const unsigned features = p->features;
	const struct surface_cut_glsl solid = surface_cut_glsl(features % SURFACE_TOOLS, cut);
	const bool by_pixel = features & SCENERY_BY_PIXEL, rakes = features & SURFACE_RAKE;
	const bool has_pattern = features & SCENERY_RELIEF || features >= SCENERY_SUBSTANCE;
	const bool has_noise = has_pattern || solid.needs_highp;
	char defines[SURFACE_DEFINES_BYTES + 200];
	int rc;

	define(defines, sizeof(defines), features, cut);
	const char *const vertex_parts[] = { defines,
					     light_glsl,
					     appearance_glsl,
					     where(rakes, rake_vertex_glsl),
					     surface_vertex_glsl,
					     where(!by_pixel, shade),
					     vertex,
					     NULL };
	const char *const fragment_parts[] = {
		where(features & SCENERY_NORMALS, derivatives),
		by_pixel || solid.needs_highp ? gl_fine_fragment : "precision mediump float;\n",
		defines,
		light_glsl,
		appearance_glsl,
		where(has_noise, noise_glsl),
		where(has_noise, substance_glsl),
		where(has_pattern, appearance_pattern_glsl),
		appearance_fog_glsl,
		where(rakes, rake_fragment_glsl),
		surface_tools_glsl,
		features & SCENERY_DISSOLVES ? surface_dissolve_glsl : surface_whole_glsl,
		painted,
		where(by_pixel, shade),
		fragment,
		NULL
	};
	const struct gl_program_source source = { .name = "scenery",
						  .vertex = vertex_parts,
						  .fragment = fragment_parts,
						  .attributes = surface_attributes };
	rc = gl_program_build(&p->program, &source);
	if (rc < 0)
		return rc;
	find_uniforms(p);
	glUseProgram(p->program);
	if (features & SCENERY_MIRROR)
		glUniform1i(glGetUniformLocation(p->program, "u_around"), 0);
	if (features & SCENERY_TEXTURE)
		glUniform1i(glGetUniformLocation(p->program, "u_texture"), 1);
	if (features & SCENERY_NORMALS)
		glUniform1i(glGetUniformLocation(p->program, "u_normals"), 2);
	return 0;
}

/* Returns the program, built or refused; NULL: neither. */
static const struct scenery_program *find(const struct scenery_programs *programs,
					  unsigned features)
{
	for (uint32_t i = 0; i < programs->count; i++)
		if (programs->all[i].features == features)
			return &programs->all[i];
	return NULL;
}

/* Builds a program; false: memory is short. */
static bool add(struct scenery_programs *programs, unsigned features)
{
	struct scenery_program *p;

	if (ARRAY_RESERVE(programs->all, programs->room, (uint64_t)programs->count + 1,
			  SCENERY_FEATURES) < 0)
		return false;
	p = &programs->all[programs->count++];
	*p = (struct scenery_program){ .features = features };
	if (build(p, programs->cut) < 0)
		p->program = 0;
	programs->is_built = true;
	return true;
}

/* Leaves out what the board cannot draw. */
static unsigned possible(unsigned features)
{
	if (!gl_has_highp())
		return features % SCENERY_SUBSTANCE & ~(unsigned)(SCENERY_RELIEF | SCENERY_NORMALS);
	if (features & SCENERY_NORMALS && !gl_has_extension("GL_OES_standard_derivatives"))
		return features & ~(unsigned)SCENERY_NORMALS;
	return features;
}

void scenery_programs_begin(struct scenery_programs *programs, uint8_t cut)
{
	if (programs->cut != cut)
		scenery_programs_finish(programs);
	programs->cut = cut;
	programs->is_built = programs->lacks = false;
}

enum { EXACT, DISSOLVING, PLAIN, BARE, RANKS };

const struct scenery_program *scenery_programs_get(struct scenery_programs *programs,
						   unsigned features)
{
	const unsigned exact = possible(features);
	const unsigned ranks[RANKS] = { [EXACT] = exact,
					[DISSOLVING] = exact | SCENERY_DISSOLVES,
					[PLAIN] = exact % SCENERY_BY_PIXEL | SCENERY_DISSOLVES,
					[BARE] = SCENERY_DISSOLVES };

	for (;;) {
		const struct scenery_program *ready = NULL;
		int missing = RANKS;

		for (int i = 0; i < RANKS && !ready; i++) {
			const struct scenery_program *p = find(programs, ranks[i]);

			if (p && p->program)
				ready = p;
			else if (!p && missing == RANKS && i != DISSOLVING)
				missing = i;
		}
		if (missing == RANKS)
			return ready;
		if (programs->is_built) {
			programs->lacks = true;
			return ready;
		}
		/* If there is none to draw with, one that serves all materials comes first. */
		if (!ready && missing == EXACT && !find(programs, ranks[PLAIN]))
			missing = PLAIN;
		if (!add(programs, ranks[missing]))
			return ready;
	}
}

const struct scenery_program *scenery_programs_make(struct scenery_programs *programs,
						    unsigned features)
{
	const struct scenery_program *p;

	features = possible(features);
	if (find(programs, features) || !add(programs, features))
		return NULL;
	p = find(programs, features);
	return p->program ? p : NULL;
}

void scenery_programs_finish(struct scenery_programs *programs)
{
	for (uint32_t i = 0; i < programs->count; i++)
		if (programs->all[i].program)
			glDeleteProgram(programs->all[i].program);
	free(programs->all);
	*programs = (struct scenery_programs){ 0 };
}
