/* Holds the GLSL of scenery and builds it by features. */
#include "render/scenery/scenery_program.h"

#include <stdio.h>

#include "base/compiler.h"
#include "geometry/appearance.h"
#include "geometry/light.h"

/* Where the light is computed, in the vertex or in the fragment shader; each uniform is in one of
 * them only, because their precisions differ. */
static const char shade[] =
	"#ifdef GLOSSY\n"
	"uniform vec4 u_specular;\n" /* colour, exponent */
	"uniform vec3 u_emissive;\n"
	"#endif\n"
	"vec3 shaded(vec3 surface, vec3 n, vec3 p, vec4 sun) {\n"
	"	vec3 colour = surface * (sun.w > 0.5 ? light(n, 1.0, sun.xyz) : 1.0);\n"
	"#ifdef GLOSSY\n"
	"	colour += u_emissive + u_specular.rgb * highlight(n, normalize(-p), sun.xyz,\n"
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
	"void main() {\n"
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

static const char fragment[] =
	/* u_light is u_sun */
	"varying vec4 v_colour;\n"
	"uniform float u_opacity;\n"
	"#ifdef BY_PIXEL\n"
	"uniform vec4 u_light;\n"
	"varying vec3 v_normal, v_place;\n"
	"#endif\n"
	"void main() {\n"
	"	vec3 colour = v_colour.rgb;\n"
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
	surface_find_tools(&p->tools, p->program);
}

static int build(struct scenery_program *p, unsigned features)
{
	const unsigned tools = features % SURFACE_TOOLS;
	const bool by_pixel = features & SCENERY_BY_PIXEL, rakes = tools & SURFACE_RAKE;
	const char *const none = "";
	char defines[80];
	int rc;

	snprintf(defines, sizeof(defines), "%s%s%s", surface_defines[tools],
		 by_pixel ? "#define BY_PIXEL\n" : "",
		 features & SCENERY_GLOSSY ? "#define GLOSSY\n" : "");
	const struct gl_program_source source = {
		.name = "scenery",
		.vertex =
			(const char *const[]){ defines, light_glsl, appearance_glsl,
					       rakes ? rake_vertex_glsl : none, surface_vertex_glsl,
					       by_pixel ? none : shade, vertex, NULL },
		.fragment =
			(const char *const[]){
				by_pixel ? gl_fine_fragment : "precision mediump float;\n", defines,
				light_glsl, appearance_glsl, appearance_fog_glsl,
				rakes ? rake_fragment_glsl : none, surface_tools_glsl,
				features & SCENERY_DISSOLVES ? surface_dissolve_glsl
							     : surface_whole_glsl,
				by_pixel ? shade : none, fragment, NULL },
		.attributes = surface_attributes,
	};
	rc = gl_program_build(&p->program, &source);
	if (rc == 0)
		find_uniforms(p);
	return rc;
}

const struct scenery_program *scenery_programs_get(struct scenery_programs *programs,
						   unsigned features)
{
	const unsigned less[] = { features, features % SCENERY_BY_PIXEL,
				  features & SCENERY_DISSOLVES };

	for (size_t i = 0; i < ARRAY_COUNT(less); i++) {
		struct scenery_program *p = &programs->of[less[i]];

		if (!p->program && !p->is_lacking)
			p->is_lacking = build(p, less[i]) < 0;
		if (!p->is_lacking)
			return p;
	}
	return NULL;
}

void scenery_programs_finish(struct scenery_programs *programs)
{
	for (int i = 0; i < SCENERY_FEATURES; i++)
		if (programs->of[i].program)
			glDeleteProgram(programs->of[i].program);
	*programs = (struct scenery_programs){ 0 };
}
