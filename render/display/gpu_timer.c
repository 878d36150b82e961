/* Keeps a ring of queries and looks, oldest first, which have a result. */
#include "render/display/gpu_timer.h"

#include <string.h>

#include <EGL/egl.h>

/* No frame takes longer. For one in which llvmpipe has nothing to draw but a clear, it returns the
 * time since the machine started. */
static const GLuint64 most_ns = 1000000000;

/* The functions of the extension, of the one GL library in the process. */
static struct {
	PFNGLGENQUERIESEXTPROC gen;
	PFNGLDELETEQUERIESEXTPROC delete;
	PFNGLBEGINQUERYEXTPROC begin;
	PFNGLENDQUERYEXTPROC end;
	PFNGLGETQUERYOBJECTUIVEXTPROC get;
	PFNGLGETQUERYOBJECTUI64VEXTPROC get_long;
} gl;

static bool find_functions(void)
{
	gl.gen = (PFNGLGENQUERIESEXTPROC)eglGetProcAddress("glGenQueriesEXT");
	gl.delete = (PFNGLDELETEQUERIESEXTPROC)eglGetProcAddress("glDeleteQueriesEXT");
	gl.begin = (PFNGLBEGINQUERYEXTPROC)eglGetProcAddress("glBeginQueryEXT");
	gl.end = (PFNGLENDQUERYEXTPROC)eglGetProcAddress("glEndQueryEXT");
	gl.get = (PFNGLGETQUERYOBJECTUIVEXTPROC)eglGetProcAddress("glGetQueryObjectuivEXT");
	gl.get_long =
		(PFNGLGETQUERYOBJECTUI64VEXTPROC)eglGetProcAddress("glGetQueryObjectui64vEXT");
	return gl.gen && gl.delete &&gl.begin && gl.end && gl.get && gl.get_long;
}

void gpu_timer_init(struct gpu_timer *timer)
{
	memset(timer, 0, sizeof(*timer));
	timer->known = gl_has_extension("GL_EXT_disjoint_timer_query") && find_functions();
	if (timer->known)
		gl.gen(GPU_TIMER_QUERIES, timer->queries);
}

void gpu_timer_finish(struct gpu_timer *timer)
{
	if (timer->known)
		gl.delete(GPU_TIMER_QUERIES, timer->queries);
	memset(timer, 0, sizeof(*timer));
}

void gpu_timer_begin(struct gpu_timer *timer)
{
	if (!timer->known || timer->begun - timer->taken == GPU_TIMER_QUERIES)
		return;
	gl.begin(GL_TIME_ELAPSED_EXT, timer->queries[timer->begun % GPU_TIMER_QUERIES]);
	timer->running = true;
}

void gpu_timer_end(struct gpu_timer *timer)
{
	if (!timer->running)
		return;
	gl.end(GL_TIME_ELAPSED_EXT);
	timer->running = false;
	timer->begun++;
}

int64_t gpu_timer_take_us(struct gpu_timer *timer)
{
	GLuint64 spent_ns = 0;
	GLint disjoint = 0;

	while (timer->begun != timer->taken) {
		const GLuint query = timer->queries[timer->taken % GPU_TIMER_QUERIES];
		GLuint done = 0;

		gl.get(query, GL_QUERY_RESULT_AVAILABLE_EXT, &done);
		if (!done)
			break;
		gl.get_long(query, GL_QUERY_RESULT_EXT, &spent_ns);
		timer->taken++;
	}
	if (spent_ns > 0)
		glGetIntegerv(GL_GPU_DISJOINT_EXT, &disjoint);
	return disjoint || spent_ns > most_ns ? 0 : (int64_t)(spent_ns / 1000);
}
