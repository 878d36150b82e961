/* The shader that computes the distance to a region per fragment. */
#include "render/patches/mark.h"

#include <math.h>
#include <string.h>

static const char mark_vertex[] =
	"invariant gl_Position;\n"
	"attribute vec3 a_position, a_base;\n"
	"uniform mat4 u_clip;\n"
	"uniform vec4 u_lattice;\n"
	"uniform vec3 u_middle;\n" /* middle of the region from the eye */
	"uniform vec4 u_cut;\n"
	"varying float v_cut;\n" /* metres in front of the section plane */
	"varying vec3 v_at;\n"   /* position from the region's middle */
	"void main() {\n"
	"	vec3 p = u_lattice.xyz + u_lattice.w * (a_base + a_position);\n"
	"	v_cut = dot(u_cut.xyz, p) - u_cut.w;\n"
	"	v_at = p - u_middle;\n"
	"	gl_Position = u_clip * vec4(p, 1.0);\n"
	"}\n";

/* The GLSL version of region_distance; both must agree. u_region[0]: kind (as in the enum), corner
 * count, floor, roof; [1].w: radius; [2]: half sides, 0; [3].xy: cosine and sine of the rotation.
 * u_corners: x, y, two corners to a vector. All positions count from the region's middle, so that
 * mediump suffices. */
static const char mark_fragment[] =
	"uniform vec4 u_region[4];\n"
	"uniform vec4 u_corners[8];\n"
	"varying vec3 v_at;\n"
	"varying float v_cut;\n"
	"float polygon(vec2 p) {\n"
	"	float nearest = 6e4, side = 1.0;\n"
	"	vec2 a = u_corners[0].xy;\n"
	"	vec2 first = a;\n"
	"	for (int i = 1; i <= 16; i++) {\n"
	"		float n = float(i);\n"
	"		if (n > u_region[0].y) break;\n"
	"		vec4 pair = u_corners[i == 16 ? 0 : i / 2];\n"
	"		vec2 b = n >= u_region[0].y ? first : (i / 2 * 2 == i ? pair.xy : pair.zw);\n"
	"		vec2 e = b - a, w = p - a;\n"
	"		vec2 d = w - e * clamp(dot(w, e) / max(dot(e, e), 1e-7), 0.0, 1.0);\n"
	"		nearest = min(nearest, dot(d, d));\n"
	"		if ((a.y > p.y) != (b.y > p.y) && w.x < w.y / e.y * e.x) side = -side;\n"
	"		a = b;\n"
	"	}\n"
	"	return side * sqrt(nearest);\n"
	"}\n"
	"float region_distance(vec3 p) {\n"
	"	if (u_region[0].x < 1.5)\n"
	"		return length(p) - u_region[1].w;\n"
	"	if (u_region[0].x > 2.5)\n"
	"		return max(polygon(p.xy), max(u_region[0].z - p.z, p.z - u_region[0].w));\n"
	"	vec2 c = u_region[3].xy;\n"
	"	vec3 q = vec3(c.x * p.x + c.y * p.y, c.x * p.y - c.y * p.x, p.z);\n"
	"	q = abs(q) - u_region[2].xyz;\n"
	"	return max(q.x, max(q.y, q.z));\n"
	"}\n"
	"void main() {\n"
	"	if (region_distance(v_at) > 0.0 || v_cut > 0.0) discard;\n"
	"	gl_FragColor = vec4(1.0);\n"
	"}\n";

int mark_init(struct mark *mark)
{
	memset(mark, 0, sizeof(*mark));
	const struct gl_program_source source = {
		.name = "mark",
		.vertex = (const char *const[]){ mark_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, mark_fragment, NULL },
		.attributes = (const char *const[]){ "a_position", "a_normal", "a_colour", "a_base",
						     NULL },
	};
	int rc = gl_program_build(&mark->program, &source);
	mark->clip = glGetUniformLocation(mark->program, "u_clip");
	mark->lattice = glGetUniformLocation(mark->program, "u_lattice");
	mark->region = glGetUniformLocation(mark->program, "u_region");
	mark->corners = glGetUniformLocation(mark->program, "u_corners");
	mark->cut = glGetUniformLocation(mark->program, "u_cut");
	mark->middle = glGetUniformLocation(mark->program, "u_middle");
	return rc;
}

void mark_finish(struct mark *mark)
{
	if (mark->program)
		glDeleteProgram(mark->program);
	memset(mark, 0, sizeof(*mark));
}

static void find_middle(float out[3], const struct region *region)
{
	memcpy(out, region->centre_m, 3 * sizeof(out[0]));
	if (region->kind != REGION_PRISM || region->corner_count < 3 ||
	    region->corner_count > REGION_CORNERS_MAX)
		return;
	out[0] = out[1] = 0;
	for (uint32_t i = 0; i < region->corner_count; i++)
		for (int k = 0; k < 2; k++)
			out[k] += region->corners_m[i][k] / (float)region->corner_count;
	out[2] = (region->floor_m + region->roof_m) / 2;
}

static void set_region(const struct mark *mark, const float middle[3], const struct region *region)
{
	float turn = region->turn_deg * (float)M_PI / 180;
	float rows[16] = { (float)region->kind,
			   (float)region->corner_count,
			   region->floor_m - middle[2],
			   region->roof_m - middle[2],
			   0,
			   0,
			   0,
			   region->radius_m,
			   region->half_m[0],
			   region->half_m[1],
			   region->half_m[2],
			   0,
			   cosf(turn),
			   sinf(turn) };
	float corners[2 * REGION_CORNERS_MAX] = { 0 };
	for (uint32_t i = 0; i < region->corner_count && i < REGION_CORNERS_MAX; i++) {
		corners[2 * i] = region->corners_m[i][0] - middle[0];
		corners[2 * i + 1] = region->corners_m[i][1] - middle[1];
	}
	glUniform4fv(mark->region, 4, rows);
	glUniform4fv(mark->corners, REGION_CORNERS_MAX / 2, corners);
}

void mark_begin(const struct mark *mark, const struct view *view, const struct root_page *root,
		const struct region *region)
{
	const struct lattice *lattice = &root->lattice;
	const float *eye = view->eye_m;
	glUseProgram(mark->program);
	glUniformMatrix4fv(mark->clip, 1, GL_FALSE, view->clip);
	glUniform4f(mark->lattice, (float)(lattice->origin_m[0] - eye[0]),
		    (float)(lattice->origin_m[1] - eye[1]), (float)(lattice->origin_m[2] - eye[2]),
		    (float)lattice->step_m);
	glUniform4fv(mark->cut, 1, view->cut);
	float middle[3];
	find_middle(middle, region);
	glUniform3f(mark->middle, middle[0] - eye[0], middle[1] - eye[1], middle[2] - eye[2]);
	set_region(mark, middle, region);
	glEnableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
}
