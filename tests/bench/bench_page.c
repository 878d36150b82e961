/* How long a page takes to open whose objects are in the cache: the whole kiosk and its fetcher,
 * fingers from a replay, the machine's own clock.
 *
 *   bench_page [KIOSK OPTIONS] --touch-replay FILE --quit-after-replay
 *
 * A line of JSON a page: from the finger's lift until the first frame with it, until it stands
 * there whole (faded in, every line of its window drawn), and until its pictures are there too; how
 * many frames that were, and how much of them was work for the words alone, whatever draws the
 * model. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/kiosk.h"
#include "base/clock.h"
#include "tests/ui/places.h"

/* The linker wraps these (Makefile). */
int __real_frame_draw(struct frame *of);
int __wrap_frame_draw(struct frame *of);
void __real_fingers_on_touch(void *data, const struct touch_event *event);
/* Of all threads: what it would take on cores of its own. */
static int64_t process_us(void)
{
	struct timespec now;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

void __wrap_fingers_on_touch(void *data, const struct touch_event *event);
bool __real_overlay_update(struct overlay *overlay, int64_t now_ms);
bool __wrap_overlay_update(struct overlay *overlay, int64_t now_ms);

static struct kiosk kiosk;
static int64_t lifted_us, lifted_cpu_us, touch_us, words_us;
static struct {
	int part; /* -1: none opens */
	int64_t began_us, first_us, whole_us;
	int64_t words_us, cpu_us, whole_cpu_us;
	uint32_t frames, whole_frames;
} opening = { .part = -1 };

void __wrap_fingers_on_touch(void *data, const struct touch_event *event)
{
	const int64_t began_us = clock_thread_us();

	if (event->phase == TOUCH_UP)
		lifted_us = clock_now_us(), lifted_cpu_us = process_us();
	__real_fingers_on_touch(data, event);
	touch_us = clock_thread_us() - began_us;
}

bool __wrap_overlay_update(struct overlay *overlay, int64_t now_ms)
{
	const int64_t began_us = clock_thread_us();
	const bool moves = __real_overlay_update(overlay, now_ms);

	words_us = clock_thread_us() - began_us;
	return moves;
}

static bool is_whole(const struct overlay *overlay)
{
	const struct rect view = page_window(overlay);
	const int last = (view.height_px - 1) / overlay->page.strip_px;
	const int end = article_layout_height_px(overlay->page.article) / overlay->page.strip_px;

	for (int i = 0; i <= last && i <= end; i++)
		if (overlay->page.strips[i].index != i || overlay->page.strips[i].fade.alpha < 1)
			return false;
	return overlay->page.fade.alpha == 1;
}

static bool has_pictures(const struct overlay *overlay)
{
	for (uint32_t i = 0; i < article_layout_picture_count(overlay->page.article); i++) {
		struct found_picture found = { 0 };
		const char *name = article_layout_picture(overlay->page.article, i, NULL);

		if (overlay->pictures.get(overlay->pictures.data, name, &found) && !found.picture)
			return false;
	}
	for (uint32_t i = 0; i < PAGE_STRIPS; i++)
		if (overlay->page.strips[i].index >= 0 && overlay->page.strips[i].stale)
			return false;
	return true;
}

static void look(const struct overlay *overlay)
{
	const int64_t now_us = clock_now_us();
	const int part = overlay_page(overlay);

	if (part != opening.part) {
		opening.part = part;
		opening.began_us = lifted_us;
		opening.first_us = now_us;
		opening.cpu_us = process_us() - lifted_cpu_us;
		opening.whole_us = 0;
		opening.words_us = touch_us;
		opening.frames = 0;
	}
	if (part < 0 || opening.began_us == 0)
		return;
	opening.frames++;
	opening.words_us += words_us;
	if (!opening.whole_us && is_whole(overlay)) {
		opening.whole_us = now_us;
		opening.whole_frames = opening.frames;
		opening.whole_cpu_us = process_us() - lifted_cpu_us;
	}
	if (!opening.whole_us || !has_pictures(overlay))
		return;
	printf("{\"part\": \"%s\", \"first_frame_ms\": %.1f, \"whole_ms\": %.1f, \"frames\": %u, "
	       "\"with_pictures_ms\": %.1f, \"words_cpu_ms\": %.2f, \"first_frame_cpu_ms\": %.1f, "
	       "\"whole_cpu_ms\": %.1f}\n",
	       info_part(exhibit_info(&kiosk.releases.sessions.shown.exhibit), (uint32_t)part)->id,
	       (double)(opening.first_us - opening.began_us) / 1000,
	       (double)(opening.whole_us - opening.began_us) / 1000, opening.whole_frames,
	       (double)(now_us - opening.began_us) / 1000, (double)opening.words_us / 1000,
	       (double)opening.cpu_us / 1000, (double)opening.whole_cpu_us / 1000);
	opening.began_us = 0;
}

int __wrap_frame_draw(struct frame *of)
{
	const int rc = __real_frame_draw(of);
	const struct overlay *overlay = exhibit_overlay(&kiosk.releases.sessions.shown.exhibit);

	if (overlay)
		look(overlay);
	return rc;
}

int main(int argc, char **argv)
{
	int rc;

	if (options_parse(&kiosk.options, argc, argv) != OPTIONS_RUN)
		return 2;
	rc = kiosk_start(&kiosk);
	if (rc == 0)
		rc = kiosk_run(&kiosk);
	kiosk_stop(&kiosk);
	return rc == 0 ? 0 : 1;
}
