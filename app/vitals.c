/* Writes the kiosk's metrics for gopura-health and Prometheus; docs/health.md lists them. They are
 * written on demand by the thread of the loop, from values that are at hand. */
#include "app/kiosk.h"
#include "app/release/updater.h"
#include "base/clock.h"
#include "base/metrics_socket.h"
#include "render/display/gl.h"

static void write_frames(const struct kiosk *kiosk, struct buffer *out)
{
	if (kiosk->last_frame_ms > 0)
		metrics_gauge(out, "gopura_kiosk_last_frame_age_seconds",
			      "Since a frame was drawn; at rest none is.",
			      (double)(clock_now_ms() - kiosk->last_frame_ms) / 1000);
	metrics_counter(out, "gopura_kiosk_frames_total", "Frames drawn.", (double)kiosk->frames);
	metrics_counter(out, "gopura_kiosk_late_frames_total",
			"Of them with more work than a panel of 60 Hz leaves.",
			(double)kiosk->late_frames);
	metrics_gauge(out, "gopura_kiosk_frame_work_seconds", "Work of the last frame.",
		      (double)kiosk->frame_us / 1e6);
	metrics_gauge(out, "gopura_kiosk_picture", "Whether the model was drawn since the start.",
		      kiosk->pictured);
}

static void write_release(const struct kiosk *kiosk, struct buffer *out)
{
	const struct scene *scene = kiosk->shown.scene;
	const struct root_page *root = scene ? scene_root(scene) : NULL;
	char hex[HASH_HEX_BYTES];

	metrics_gauge(out, "gopura_kiosk_release_sequence",
		      "Of the release that is remembered, 0: none yet.",
		      (double)updater_sequence(kiosk->updater));
	metrics_gauge(out, "gopura_kiosk_clock_trusted",
		      "Whether the clock is known to be set, so that expiry is judged.",
		      clock_wall_is_set());
	if (!root)
		return;
	hash_to_hex(kiosk->shown.root, hex);
	metrics_info(out, "gopura_kiosk_release_info", "The release that is shown.",
		     (const struct figure_label[]){ { "root", hex }, { "name", root->name } }, 2);
}

static void write_refusal(const struct kiosk *kiosk, struct buffer *out)
{
	const struct refusal *refusal = updater_refusal(kiosk->updater);

	metrics_counter(out, "gopura_kiosk_refusals_total", "Releases and their files refused.",
			(double)refusal->count);
	if (refusal->count == 0)
		return;
	metrics_gauge(out, "gopura_kiosk_refused_at_seconds", "When the last one was.",
		      (double)refusal->at_s);
	metrics_info(
		out, "gopura_kiosk_refusal_info", "What it was, and why.",
		(const struct figure_label[]){ { "what", refusal->what }, { "why", refusal->why } },
		2);
}

static void write_memory(const struct kiosk *kiosk, struct buffer *out)
{
	const struct scene_options budget =
		kiosk_scene_options(&kiosk->profile, kiosk->options.mode);
	struct scene_memory memory = { 0 };

	if (kiosk->shown.scene)
		scene_memory(kiosk->shown.scene, &memory);
	metrics_gauge(out, "gopura_kiosk_texture_bytes", "Tiles and depths that are held.",
		      (double)memory.texture_bytes);
	metrics_gauge(out, "gopura_kiosk_texture_budget_bytes", "What they may take.",
		      (double)budget.texture_budget_bytes);
	metrics_gauge(out, "gopura_kiosk_geometry_bytes", "Patches that are held.",
		      (double)memory.geometry_bytes);
	metrics_gauge(out, "gopura_kiosk_geometry_budget_bytes", "What they may take.",
		      (double)budget.geometry_budget_bytes);
}

static void write_board(const struct kiosk *kiosk, struct buffer *out)
{
	const char *renderer = (const char *)glGetString(GL_RENDERER);

	metrics_info(out, "gopura_kiosk_gl_info", "What draws.",
		     (const struct figure_label[]){ { "renderer", renderer ? renderer : "" } }, 1);
	metrics_gauge(out, "gopura_kiosk_wanted", "Objects asked of the fetcher and not yet here.",
		      kiosk->wants.said_count);
	/* With a replayed file, or in a window, no touch device is expected. */
	if (kiosk->touch && !kiosk->options.touch_replay_path)
		metrics_gauge(out, "gopura_kiosk_touch_devices", "Touch devices that are open.",
			      touch_device_count(kiosk->touch));
}

static void write_figures(void *data, struct buffer *out)
{
	const struct kiosk *kiosk = data;

	write_frames(kiosk, out);
	write_release(kiosk, out);
	write_refusal(kiosk, out);
	write_memory(kiosk, out);
	write_board(kiosk, out);
}

int vitals_offer(struct kiosk *kiosk)
{
	const struct metrics_socket_options options = {
		.path = kiosk->options.metrics_path,
		.prefix = "gopura_kiosk",
		.write = write_figures,
		.data = kiosk,
	};
	int rc = 0;

	if (options.path)
		rc = metrics_socket_create(&kiosk->metrics, &options);
	if (rc == 0)
		rc = kiosk_watch(kiosk, metrics_socket_fd(kiosk->metrics));
	return rc;
}
