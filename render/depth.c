#include "render/depth.h"

#include <errno.h>
#include <string.h>

#include "render/vec.h"

static const char draw_vertex[] =
	"attribute vec3 a_position;\n"
	"uniform vec4 u_lattice;\n" /* of the lattice's origin from the point, metres; step */
	"uniform mat3 u_axes;\n"
	"uniform float u_far;\n"
	"uniform vec4 u_window;\n"
	"varying float v_depth;\n"
	"void main() {\n"
	"	vec3 q = u_axes * (u_lattice.xyz + u_lattice.w * a_position);\n"
	/* Sampling points lie as far apart as the model is large, and as far from it. */
	"	float n = u_far * 0.0007;\n"
	/* Row 0 of a face is its top and row 0 of a texture its bottom: y is turned over. */
	"	vec2 at = (q.xy - u_window.xy * q.z) / u_window.zw;\n"
	"	gl_Position = vec4(at.x, -at.y, ((u_far + n) * q.z - 2.0 * u_far * n) / (u_far - n),\n"
	"			   q.z);\n"
	"	v_depth = q.z / u_far;\n"
	"}\n";

static const char draw_fragment[] =
	"precision highp float;\n"
	"varying float v_depth;\n"
	"void main() {\n"
	"	float value = clamp(v_depth, 0.0, 1.0) * 65535.0;\n"
	"	float high = floor(value / 256.0);\n"
	"	gl_FragColor = vec4(high, floor(value - high * 256.0), 0.0, 255.0) / 255.0;\n"
	"}\n";

static const char grow_fragment[] =
	"precision highp float;\n"
	"uniform highp sampler2D u_raw;\n" /* by default lowp: 16 bits of depth need more */
	"uniform float u_texel;\n"
	"varying vec2 v_at;\n"
	"float depth_at(vec2 at) {\n"
	"	vec4 t = texture2D(u_raw, at);\n"
	"	return t.a < 0.5 ? 1.0 : (t.r * 256.0 + t.g) * 255.0 / 65535.0;\n"
	"}\n"
	"void main() {\n"
	"	float own = depth_at(v_at), nearest = own;\n"
	"	for (int y = -1; y <= 1; y++)\n"
	"		for (int x = -1; x <= 1; x++)\n"
	"			nearest = min(nearest, depth_at(v_at + u_texel\n"
	"							* vec2(float(x), float(y))));\n"
	/* A step: more than a surface seen at a grazing angle climbs in a texel. */
	"	float jump = 0.06 * own;\n"
	"	float z = own - nearest > jump ? nearest : own;\n"
	"	float value = floor(z * 65535.0 + 0.5), high = floor(value / 2048.0);\n"
	"	float low = mod(value, 32.0), middle = floor(mod(value, 2048.0) / 32.0);\n"
	"	gl_FragColor = vec4(high / 31.0, middle / 63.0, low / 31.0, 1.0);\n"
	"}\n";

static int build_programs(struct depth *depth)
{
	const struct gl_program_source draw = {
		.name = "face depth",
		.vertex = (const char *const[]){ draw_vertex, NULL },
		.fragment = (const char *const[]){ draw_fragment, NULL },
		.attributes = (const char *const[]){ "a_position", NULL },
	};
	const struct gl_program_source grow = {
		.name = "face depth, grown",
		.vertex = (const char *const[]){ gl_square_vertex, NULL },
		.fragment = (const char *const[]){ grow_fragment, NULL },
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
	glUseProgram(depth->grow_program);
	glUniform1i(glGetUniformLocation(depth->grow_program, "u_raw"), 0);
	glUniform1f(glGetUniformLocation(depth->grow_program, "u_texel"),
		    1.0f / (float)depth->face_px);
	return 0;
}

static int make_atlas_of(struct depth *depth, GLenum format, GLenum type, bool *complete)
{
	const struct gl_texture_options atlas = { .width_px = depth->atlas_width_px,
						  .height_px = depth->atlas_height_px,
						  .format = format,
						  .type = type,
						  .filter = GL_NEAREST };
	int rc = gl_texture_create(&depth->atlas, &atlas);
	if (rc < 0)
		return rc;
	glGenFramebuffers(1, &depth->framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, depth->framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, depth->atlas,
			       0);
	*complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
	return gl_check("making the depth atlas");
}

static int make_atlas(struct depth *depth)
{
	bool complete;
	int rc = make_atlas_of(depth, GL_RGB, GL_UNSIGNED_SHORT_5_6_5, &complete);
	if (rc < 0 || complete)
		return rc;
	/* GLES2 leaves open what can be drawn into; 5, 6 and 5 bits survive in 8 as well. */
	glDeleteFramebuffers(1, &depth->framebuffer);
	glDeleteTextures(1, &depth->atlas);
	rc = make_atlas_of(depth, GL_RGBA, GL_UNSIGNED_BYTE, &complete);
	return rc < 0 || complete ? rc : -ENOTSUP;
}

int depth_init(struct depth *depth, int face_px, uint32_t face_rows)
{
	memset(depth, 0, sizeof(*depth));
	depth->face_px = face_px;
	depth->atlas_width_px = TILES_FACES_ACROSS * face_px;
	depth->atlas_height_px = (int)face_rows * face_px;
	depth->far_limit_m = 1;
	int rc = build_programs(depth);
	if (rc == 0)
		rc = gl_target_create(&depth->raw, face_px, face_px);
	if (rc == 0)
		rc = make_atlas(depth);
	if (rc < 0)
		depth_finish(depth);
	return rc;
}

void depth_finish(struct depth *depth)
{
	gl_target_destroy(&depth->raw);
	if (depth->framebuffer)
		glDeleteFramebuffers(1, &depth->framebuffer);
	if (depth->atlas)
		glDeleteTextures(1, &depth->atlas);
	if (depth->draw_program)
		glDeleteProgram(depth->draw_program);
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

/* What shows of an edge in a face's plane; nothing behind the point. */
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

/* Of the face that part in which the box shows, with a texel around it. */
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

void depth_begin(struct depth *depth, face_key face, const float sample_m[3],
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
	find_window(depth->begun, axes, sample_m, root, depth->face_px);
	gl_target_bind(&depth->raw);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	glUseProgram(depth->draw_program);
	glUniform4f(depth->lattice, (float)(lattice->origin_m[0] - sample_m[0]),
		    (float)(lattice->origin_m[1] - sample_m[1]),
		    (float)(lattice->origin_m[2] - sample_m[2]), (float)lattice->step_m);
	glUniformMatrix3fv(depth->axes, 1, GL_FALSE, columns);
	glUniform1f(depth->far_m, depth->far_limit_m);
	glUniform4fv(depth->window, 1, depth->begun);
}

void depth_end(struct depth *depth, int slot, face_key face, uint64_t cut)
{
	glBindFramebuffer(GL_FRAMEBUFFER, depth->framebuffer);
	glViewport(slot % TILES_FACES_ACROSS * depth->face_px,
		   slot / TILES_FACES_ACROSS * depth->face_px, depth->face_px, depth->face_px);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_DITHER); /* its bits are no colour's */
	glUseProgram(depth->grow_program);
	gl_bind_texture(0, depth->raw.colour);
	gl_draw_square();
	glEnable(GL_DEPTH_TEST);
	struct depth_face *drawn = &depth->face[slot];
	*drawn = (struct depth_face){ .ready = true, .key = face, .cut = cut };
	memcpy(drawn->window, depth->begun, sizeof(drawn->window));
}

bool depth_ready(const struct depth *depth, int slot, face_key face)
{
	return depth->face[slot].ready && depth->face[slot].key == face;
}
