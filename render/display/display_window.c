/* The window backend, by SDL2, for development; the mouse acts as one finger. SDL has no descriptor
 * to wait on, so a timer descriptor polls it. That costs wake-ups, which is acceptable because a
 * window never runs unattended. */
#include "render/display/display_window.h"

#include <SDL.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "base/log.h"
#include "render/display/display.h"
#include "render/display/gl.h"

enum { POLL_MS = 8 };

struct window_display {
	SDL_Window *window;
	SDL_GLContext context;
	struct display_options options; /* copied for its callbacks */
};

static int create(struct display *display, const struct display_options *options)
{
	const struct itimerspec period = { { 0, POLL_MS * 1000000 }, { 0, POLL_MS * 1000000 } };
	struct window_display *window = calloc(1, sizeof(*window));

	if (!window)
		return -ENOMEM;
	display->state = window;
	window->options = *options;
	if (SDL_Init(SDL_INIT_VIDEO) < 0)
		return -ENODEV;
	SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_ES);
	SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 2);
	SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 0);
	SDL_GL_SetAttribute(SDL_GL_DEPTH_SIZE, 24);
	display->width_px = options->width_px ? options->width_px : 1280;
	display->height_px = options->height_px ? options->height_px : 720;
	window->window = SDL_CreateWindow(options->title ? options->title : "Gopura",
					  SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
					  display->width_px, display->height_px, SDL_WINDOW_OPENGL);
	if (window->window)
		window->context = SDL_GL_CreateContext(window->window);
	if (!window->context) {
		log_info("render", "no window: %s", SDL_GetError());
		return -ENODEV;
	}
	SDL_GL_SetSwapInterval(1);
	display->fd = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	if (display->fd < 0 || timerfd_settime(display->fd, 0, &period, NULL) < 0)
		return -errno;
	return 0;
}

static void destroy(struct display *display)
{
	struct window_display *window = display->state;

	if (!window)
		return;
	if (display->fd >= 0)
		close(display->fd);
	if (window->context)
		SDL_GL_DeleteContext(window->context);
	if (window->window)
		SDL_DestroyWindow(window->window);
	SDL_Quit();
	free(window);
	display->state = NULL;
}

static void tell(struct window_display *window, enum pointer_kind kind, int x, int y, float steps)
{
	const struct display_options *options = &window->options;

	if (options->pointer)
		options->pointer(options->data, kind, (float)x, (float)y, steps);
}

static void on_event(struct window_display *window, const SDL_Event *event)
{
	int x, y;

	switch (event->type) {
	case SDL_QUIT:
		if (window->options.closed)
			window->options.closed(window->options.data);
		break;
	case SDL_MOUSEBUTTONDOWN:
		if (event->button.button == SDL_BUTTON_LEFT)
			tell(window, POINTER_DOWN, event->button.x, event->button.y, 0);
		break;
	case SDL_MOUSEBUTTONUP:
		if (event->button.button == SDL_BUTTON_LEFT)
			tell(window, POINTER_UP, event->button.x, event->button.y, 0);
		break;
	case SDL_MOUSEMOTION:
		tell(window, POINTER_MOVE, event->motion.x, event->motion.y, 0);
		break;
	case SDL_MOUSEWHEEL:
		SDL_GetMouseState(&x, &y);
		tell(window, POINTER_WHEEL, x, y, (float)event->wheel.y);
		break;
	}
}

static int dispatch(struct display *display)
{
	uint64_t expirations;
	SDL_Event event;

	if (read(display->fd, &expirations, sizeof(expirations)) < 0 && errno != EAGAIN)
		return -errno;
	while (SDL_PollEvent(&event))
		on_event(display->state, &event);
	return 0;
}

static void begin(struct display *display)
{
	(void)display;
	gl_bind_framebuffer(0); /* the default framebuffer of the window */
}

static int present(struct display *display)
{
	struct window_display *window = display->state;

	SDL_GL_SwapWindow(window->window);
	return 0;
}

const struct display_backend display_window = {
	.name = "window",
	.create = create,
	.destroy = destroy,
	.dispatch = dispatch,
	.begin = begin,
	.present = present,
};
