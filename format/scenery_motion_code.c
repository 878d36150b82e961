/* Encodes and decodes what moves in scenery, and what moves it. */
#include "format/scenery_motion_code.h"

#include <errno.h>

void scenery_put_floats(struct buffer *out, const float *numbers, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		buffer_put_f32(out, numbers[i]);
}

void scenery_get_floats(struct reader *in, float *numbers, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		numbers[i] = reader_f32(in);
}

bool scenery_get_flag(struct reader *in)
{
	uint8_t flag = reader_u8(in);

	in->failed = in->failed || flag > 1;
	return flag;
}

void scenery_put_motions(struct buffer *out, const struct scenery *scenery)
{
	for (uint32_t i = 0; i < scenery->motion_count; i++) {
		const struct scenery_motion *motion = &scenery->motions[i];

		buffer_put_f32(out, motion->duration_s);
		buffer_put_u8(out, motion->loops);
		buffer_put_u8(out, motion->returns);
		buffer_put_u32(out, motion->track_count);
	}
	for (uint32_t i = 0; i < scenery->touch_count; i++) {
		buffer_put_u32(out, scenery->touches[i].node);
		buffer_put_u32(out, scenery->touches[i].motion);
	}
	for (uint32_t i = 0; i < scenery->track_count; i++) {
		const struct scenery_track *track = &scenery->tracks[i];

		buffer_put_u32(out, track->node);
		buffer_put_u8(out, (uint8_t)track->target);
		buffer_put_u32(out, track->key_count);
	}
	scenery_put_floats(out, scenery->numbers, scenery->number_count);
}

int scenery_get_motions(struct reader *in, struct scenery *scenery)
{
	uint32_t next = 0;

	for (uint32_t i = 0; i < scenery->motion_count; i++) {
		struct scenery_motion *motion = &scenery->motions[i];

		motion->duration_s = reader_f32(in);
		motion->loops = scenery_get_flag(in);
		motion->returns = scenery_get_flag(in);
		motion->first_track = next;
		motion->track_count = reader_u32(in);
		if (motion->track_count > SCENERY_TRACKS_MAX)
			return -EBADMSG;
		next += motion->track_count;
	}
	for (uint32_t i = 0; i < scenery->touch_count; i++) {
		scenery->touches[i].node = reader_u32(in);
		scenery->touches[i].motion = reader_u32(in);
	}
	next = 0;
	for (uint32_t i = 0; i < scenery->track_count; i++) {
		struct scenery_track *track = &scenery->tracks[i];

		track->node = reader_u32(in);
		track->target = reader_u8(in);
		track->first = next;
		track->key_count = reader_u32(in);
		if ((unsigned)track->target >= SCENERY_TARGETS ||
		    track->key_count > SCENERY_NUMBERS_MAX)
			return -EBADMSG;
		next += track->key_count * (1 + scenery_width(track->target));
	}
	scenery_get_floats(in, scenery->numbers, scenery->number_count);
	return 0;
}

void scenery_put_drags(struct buffer *out, const struct scenery *scenery)
{
	for (uint32_t i = 0; i < scenery->drag_count; i++) {
		const struct scenery_drag *drag = &scenery->drags[i];

		buffer_put_u32(out, drag->handle);
		buffer_put_u32(out, drag->node);
		buffer_put_u8(out, (uint8_t)drag->kind);
		buffer_put_u8(out, drag->keeps);
		scenery_put_floats(out, drag->offset, 4);
		scenery_put_floats(out, drag->low, 2);
		scenery_put_floats(out, drag->high, 2);
		buffer_put_f32(out, drag->disc_rad);
	}
}

void scenery_get_drags(struct reader *in, struct scenery *scenery)
{
	for (uint32_t i = 0; i < scenery->drag_count; i++) {
		struct scenery_drag *drag = &scenery->drags[i];

		drag->handle = reader_u32(in);
		drag->node = reader_u32(in);
		drag->kind = reader_u8(in);
		drag->keeps = scenery_get_flag(in);
		scenery_get_floats(in, drag->offset, 4);
		scenery_get_floats(in, drag->low, 2);
		scenery_get_floats(in, drag->high, 2);
		drag->disc_rad = reader_f32(in);
	}
}
