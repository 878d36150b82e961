/* The shader programs that colour a patch: by its own colours under the light, and by the images of
 * the faces that see it, tested for occlusion, weighted and blended (docs/lumigraph.md). */
#ifndef GOPURA_RENDER_LUMIGRAPH_SURFACE_H
#define GOPURA_RENDER_LUMIGRAPH_SURFACE_H

#include "format/root_page.h"
#include "geometry/view.h"
#include "render/lumigraph/depth.h"
#include "render/lumigraph/raking_light.h"
#include "render/lumigraph/tiles.h"
#include "render/patches/dissolve.h"
#include "render/patches/patch_buffers.h"

/* A program for each number of faces (none means the patch's own colours, the cheapest), and as
 * many again for patches that dissolve, which discard pixels. */
enum { SURFACE_PROGRAMS = 2 * (PLAN_ENTRIES + 1) };

/* The same set for each combination of active tools. It is built when first drawn with, because
 * most visits need none. */
enum { SURFACE_RAKE = 1, SURFACE_CUT = 2, SURFACE_FOG = 4, SURFACE_TOOLS = 8 };

/* Fog of the scenery (format/scenery.h), which hides the scan too. Zeroed is none. */
struct surface_fog {
	float share; /* how much of it is seen, 0 to 1 */
	float range_m;
	bool is_exponential;
	float rgb[3];
};

/* The places of the uniforms that the tools have; -1 where the program lacks one. */
struct surface_tool_uniforms {
	GLint rake, cut, far, fog, thick, stand, pixel;
};

enum { SURFACE_DEFINES_BYTES = 160 };

struct surface_program {
	GLuint program;
	bool is_drawn[2]; /* something was, by surface_frame.is_direct */
	GLint clip, lattice, sun, eye, face, place, window, base, tune, share, depth, slack, range;
	struct surface_tool_uniforms tools;
};

struct surface {
	struct surface_program of[SURFACE_TOOLS][SURFACE_PROGRAMS];
	const struct surface_program *used; /* program of the last surface_begin */
	const struct tiles *tiles;          /* borrowed */
	uint8_t cut;               /* root_page.cut that the programs with a section have */
	bool lacks[SURFACE_TOOLS]; /* the driver refused one: drawn without the tools */
};

/* Builds the programs without tools. tiles gives the texture sizes; it is borrowed and must outlive
 * the surface. Errors as gl_program_build. */
must_check int surface_init(struct surface *surface, const struct tiles *tiles);
/* Deletes the programs; zeroed is fine. */
void surface_finish(struct surface *surface);

struct surface_frame {
	const struct view *view;
	const struct root_page *root;
	const struct tiles *tiles; /* NULL: only the patches' own colours */
	const struct depth *depth;
	const struct repository *repository;
	int faces;        /* that a piece blends at most: those of the largest weight */
	struct rake rake; /* the raking light; the section plane is in the view */
	struct surface_fog fog;
	/* faces have the weight of their blend, whatever they see (the eight corners) */
	bool even;
	bool shares;    /* draws the share of a pixel that images colour, instead of its colour */
	bool is_direct; /* drawn into the caller's framebuffer, whose format may not be a target's
			 */
};

/* Returns the active tools, bits of SURFACE_RAKE, SURFACE_CUT and SURFACE_FOG. */
unsigned surface_tools(const struct surface_frame *frame);

/* Finds and sets the uniforms of the tools, for the program in use. */
void surface_find_tools(struct surface_tool_uniforms *out, GLuint program);
void surface_set_tools(const struct surface_tool_uniforms *at, const struct surface_frame *frame);

/* Writes the definitions of a set of tools, of at most SURFACE_DEFINES_BYTES. cut: root_page.cut.
 */
void surface_define(char *out, unsigned tools, unsigned cut);
/* Returns what a fragment shader needs before surface_tools_glsl for those definitions. */
struct surface_cut_glsl {
	const char *noise, *substance; /* "": nothing */
	bool needs_highp;
};
struct surface_cut_glsl surface_cut_glsl(unsigned tools, unsigned cut);

/* The GLSL of the cheapest programs, for others that draw surfaces under the same light and tools.
 * A vertex shader is: what surface_define writes, light_glsl, rake_vertex_glsl where the tools
 * have it, surface_vertex_glsl, and a main() that calls unit_normal(), own_colour() and use_tools()
 * and sets v_colour. A fragment shader is: a precision, the defines, rake_fragment_glsl likewise,
 * appearance_fog_glsl, what surface_cut_glsl says, surface_tools_glsl, surface_whole_glsl or
 * surface_dissolve_glsl, surface_plain_glsl or a main() that does the same. Uniforms are those of
 * surface_begin. */
extern const char surface_vertex_glsl[], surface_tools_glsl[], surface_plain_glsl[];
extern const char surface_whole_glsl[], surface_dissolve_glsl[];
extern const char *const surface_attributes[];

/* Returns the program for a piece, by how many of its faces can be drawn now; negative where the
 * piece is drawn nowhere. */
int surface_choose(const struct surface_frame *frame, const struct blend blend[PLAN_ENTRIES],
		   struct dissolve_range range);
/* Returns how many faces a program blends: 0..PLAN_ENTRIES. */
int surface_faces(int program);
/* Builds one of the programs that the tools of the frame still lack. Returns whether there was none
 * left to build, or the driver refused one. */
bool surface_prepare(struct surface *surface, const struct surface_frame *frame);
/* Returns whether nothing was drawn with the program yet in such a frame: a driver compiles it for
 * the first triangle, which can take longer than many frames. */
bool surface_is_new(const struct surface *surface, const struct surface_frame *frame, int program);
/* Sets up the state and uniforms of a program. Then, per patch, call geometry_bind and
 * surface_dissolve, and per piece surface_blend (unless the program blends no faces). With a
 * section plane both sides of triangles must be drawn: back faces show where solid matter is
 * cut. */
void surface_begin(struct surface *surface, const struct surface_frame *frame, int program);
/* Sets the pixels in which the next patch is drawn; no effect in programs that draw it whole. */
void surface_dissolve(const struct surface *surface, struct dissolve_range range);
/* Sets the faces of the next piece; error_m as in plan_quality. */
void surface_blend(const struct surface *surface, const struct surface_frame *frame, int program,
		   const struct blend blend[PLAN_ENTRIES], const struct piece *piece,
		   float error_m);

#endif
