/* Writes each metric with its name and help text. */
#include "app/vitals.h"

#include "base/clock.h"
#include "base/metrics_socket.h"
#include "render/display/gl.h"

static void write_frames(const struct vitals *vitals, struct buffer *out)
{
	if (vitals->frame->last_ms > 0)
		metrics_gauge(out, "gopura_kiosk_last_frame_age_seconds",
			      "Since a frame was drawn; at rest none is.",
			      (double)(clock_now_ms() - vitals->frame->last_ms) / 1000);
	metrics_counter(out, "gopura_kiosk_frames_total", "Frames drawn.",
			(double)vitals->frame->count);
	metrics_counter(out, "gopura_kiosk_late_frames_total",
			"Of them with more work than a panel of 60 Hz leaves.",
			(double)vitals->frame->late_count);
	metrics_gauge(out, "gopura_kiosk_frame_work_seconds", "Work of the last frame.",
		      (double)vitals->frame->work_us / 1e6);
	metrics_gauge(out, "gopura_kiosk_picture", "Whether the model was drawn since the start.",
		      vitals->frame->pictured_ms > 0);
}

static void write_release(const struct vitals *vitals, struct buffer *out)
{
	const struct scene *scene = vitals->sessions->shown.exhibit.scene;
	const struct root_page *root = scene ? scene_root(scene) : NULL;
	char hex[HASH_HEX_BYTES];

	metrics_gauge(out, "gopura_kiosk_release_sequence",
		      "Of the release that is remembered, 0: none yet.",
		      (double)updater_sequence(vitals->updater));
	metrics_gauge(out, "gopura_kiosk_clock_trusted",
		      "Whether the clock is known to be set, so that expiry is judged.",
		      clock_wall_is_set());
	if (!root)
		return;
	hash_to_hex(vitals->sessions->shown.exhibit.root, hex);
	metrics_info(out, "gopura_kiosk_release_info", "The release that is shown.",
		     (const struct figure_label[]){ { "root", hex }, { "name", root->name } }, 2);
}

static void write_expiry(struct buffer *out, const char *name, const char *help, int64_t expires_s)
{
	if (expires_s > 0)
		metrics_gauge(out, name, help, (double)expires_s);
}

static void write_trust(const struct vitals *vitals, struct buffer *out)
{
	struct updater_trust trust;

	updater_trust(vitals->updater, &trust);
	metrics_gauge(out, "gopura_kiosk_trust_tuf",
		      "Whether The Update Framework is followed, 0: the earlier form.", trust.tuf);
	metrics_gauge(out, "gopura_kiosk_trust_root_version", "Of the trusted root, 0: none.",
		      trust.root_version);
	if (trust.tuf)
		metrics_gauge(out, "gopura_kiosk_trust_timestamp_version",
			      "Of the timestamp that was accepted last.", trust.timestamp_version);
	write_expiry(out, "gopura_kiosk_trust_root_expires_at_seconds", "When the root expires.",
		     trust.root_expires_s);
	write_expiry(out, "gopura_kiosk_trust_timestamp_expires_at_seconds",
		     "When the timestamp expires that was accepted last.",
		     trust.timestamp_expires_s);
	write_expiry(out, "gopura_kiosk_trust_release_expires_at_seconds",
		     "When the release, its snapshot or its targets expire.",
		     trust.release_expires_s);
}

static void write_refusal(const struct vitals *vitals, struct buffer *out)
{
	const struct metrics_refusal *refusal = updater_refusal(vitals->updater);

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

static void write_memory(const struct vitals *vitals, struct buffer *out)
{
	const struct scene_options *budget = &vitals->sessions->options.scene;
	const struct scene *scene = vitals->sessions->shown.exhibit.scene;
	struct scene_memory memory = { 0 };

	if (scene)
		scene_memory(scene, &memory);
	metrics_gauge(out, "gopura_kiosk_texture_bytes", "Tiles and depths that are held.",
		      (double)memory.texture_bytes);
	metrics_gauge(out, "gopura_kiosk_texture_budget_bytes", "What they may take.",
		      (double)budget->texture_budget_bytes);
	metrics_gauge(out, "gopura_kiosk_geometry_bytes", "Patches that are held.",
		      (double)memory.geometry_bytes);
	metrics_gauge(out, "gopura_kiosk_geometry_budget_bytes", "What they may take.",
		      (double)budget->geometry_budget_bytes);
}

static void write_board(const struct vitals *vitals, struct buffer *out)
{
	const char *renderer = (const char *)glGetString(GL_RENDERER);

	metrics_info(out, "gopura_kiosk_gl_info", "What draws.",
		     (const struct figure_label[]){ { "renderer", renderer ? renderer : "" } }, 1);
	metrics_gauge(out, "gopura_kiosk_wanted", "Objects asked of the fetcher and not yet here.",
		      vitals->wants->said_count);
	if (vitals->touch)
		metrics_gauge(out, "gopura_kiosk_touch_devices", "Touch devices that are open.",
			      touch_device_count(vitals->touch));
}

static void write_figures(void *data, struct buffer *out)
{
	const struct vitals *vitals = data;

	write_frames(vitals, out);
	write_release(vitals, out);
	write_trust(vitals, out);
	write_refusal(vitals, out);
	write_memory(vitals, out);
	write_board(vitals, out);
}

int vitals_offer(struct metrics_socket **out, const struct vitals *vitals, const char *path)
{
	const struct metrics_socket_options options = {
		.path = path,
		.prefix = "gopura_kiosk",
		.write = write_figures,
		.data = (void *)vitals,
	};

	return metrics_socket_create(out, &options);
}
