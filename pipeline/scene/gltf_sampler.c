/* Reads animation samplers. Values change evenly between the keys that it gives, so a step becomes
 * two keys at one time, and a cubic spline straight pieces. */
#include "pipeline/scene/gltf_sampler.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <string.h>

#include "pipeline/scene/gltf_nodes.h"

static const char *text_of(const cJSON *object, const char *field)
{
	return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, field));
}

static int read_sampler(struct gltf_sampler *out, const struct gltf *gltf, const cJSON *animation,
			const cJSON *channel, uint32_t width, bool is_flat)
{
	const cJSON *number = cJSON_GetObjectItemCaseSensitive(channel, "sampler");
	const cJSON *sampler =
		cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(animation, "samplers"),
				   cJSON_IsNumber(number) ? number->valueint : -1);
	const char *shape = text_of(sampler, "interpolation");
	float before = -1;
	int rc;

	*out = (struct gltf_sampler){ .width = width, .is_flat = is_flat };
	if (!cJSON_IsObject(sampler))
		return gltf_say(gltf, -EBADMSG, channel,
				"a channel of animation \"%.60s\" has no sampler; export it anew",
				gltf_name(animation));
	out->shape = shape && strcmp(shape, "STEP") == 0          ? GLTF_STEP
		     : shape && strcmp(shape, "CUBICSPLINE") == 0 ? GLTF_CUBIC
								  : GLTF_LINEAR;
	rc = gltf_numbers_of(&out->times, gltf, sampler, "input", 1);
	if (rc == 0)
		rc = gltf_numbers_of(&out->values, gltf, sampler, "output", is_flat ? 1 : width);
	if (rc < 0)
		return rc;
	if (out->times.count == 0 ||
	    out->values.count != (uint64_t)out->times.count * (out->shape == GLTF_CUBIC ? 3 : 1) *
					 (is_flat ? width : 1))
		return gltf_say(gltf, -EBADMSG, sampler,
				"animation \"%.60s\" has another number of times than of values; "
				"export it anew",
				gltf_name(animation));
	for (uint32_t i = 0; i < out->times.count; i++) {
		const float time = gltf_number(&out->times, i, 0);

		if (!(time > before && time <= 3600))
			return gltf_say(
				gltf, -EBADMSG, sampler,
				"animation \"%.60s\" has times that do not ascend from 0 to "
				"at most 3600 seconds; correct its keys",
				gltf_name(animation));
		before = time;
	}
	return 0;
}

int gltf_sampler_read(struct gltf_sampler *out, const struct gltf *gltf, const cJSON *animation,
		      const cJSON *channel, uint32_t width)
{
	return read_sampler(out, gltf, animation, channel, width, false);
}

int gltf_sampler_read_weights(struct gltf_sampler *out, const struct gltf *gltf,
			      const cJSON *animation, const cJSON *channel, uint32_t width)
{
	return read_sampler(out, gltf, animation, channel, width, true);
}

float gltf_sampler_end_s(const struct gltf_sampler *sampler)
{
	return gltf_number(&sampler->times, sampler->times.count - 1, 0);
}

uint32_t gltf_sampler_key_count(const struct gltf_sampler *sampler)
{
	const uint32_t count = sampler->times.count;

	return sampler->shape == GLTF_STEP    ? 2 * count - 1
	       : sampler->shape == GLTF_CUBIC ? GLTF_PIECES * (count - 1) + 1
					      : count;
}

/* Returns number k of the element `at` of the output, as the file has it. */
static float number_at(const struct gltf_sampler *sampler, uint32_t at, uint32_t k)
{
	return sampler->is_flat ? gltf_number(&sampler->values, at * sampler->width + k, 0)
				: gltf_number(&sampler->values, at, k);
}

float gltf_sampler_key(float *value, const struct gltf_sampler *sampler, uint32_t key)
{
	const struct gltf_numbers *times = &sampler->times;
	uint32_t at = key;
	float from_s, span_s, t;

	if (sampler->shape != GLTF_CUBIC) {
		at = sampler->shape == GLTF_STEP ? key / 2 : key;
		for (uint32_t k = 0; k < sampler->width; k++)
			value[k] = number_at(sampler, at, k);
		return gltf_number(times, sampler->shape == GLTF_STEP ? (key + 1) / 2 : key, 0);
	}
	/* Each key has its tangent before, its value and its tangent after (3.11, appendix C). */
	at = key / GLTF_PIECES;
	t = (float)(key % GLTF_PIECES) / GLTF_PIECES;
	from_s = gltf_number(times, at, 0);
	span_s = at + 1 < times->count ? gltf_number(times, at + 1, 0) - from_s : 0;
	for (uint32_t k = 0; k < sampler->width; k++) {
		const float from = number_at(sampler, 3 * at + 1, k);

		value[k] = from;
		if (t > 0)
			value[k] = (2 * t * t * t - 3 * t * t + 1) * from +
				   span_s * (t * t * t - 2 * t * t + t) *
					   number_at(sampler, 3 * at + 2, k) +
				   (3 * t * t - 2 * t * t * t) * number_at(sampler, 3 * at + 4, k) +
				   span_s * (t * t * t - t * t) * number_at(sampler, 3 * at + 3, k);
	}
	return from_s + t * span_s;
}

bool gltf_make_turn(float value[4])
{
	float length = 0;

	for (int k = 0; k < 4; k++)
		length += value[k] * value[k];
	length = sqrtf(length);
	for (int k = 0; k < 4; k++)
		value[k] /= length;
	return isfinite(length) && length > 1e-6f;
}
