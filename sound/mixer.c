/* ALSA's simple mixer: controls by name, whatever the card has. */
#include "sound/mixer.h"

#include <alsa/asoundlib.h>
#include <string.h>
#include <strings.h>

#include "base/compiler.h"
#include "base/log.h"

static bool has_word(const char *name, const char *word)
{
	static const char between[] = " -_";

	for (name += strspn(name, between); *name; name += strspn(name, between)) {
		const size_t size = strcspn(name, between);

		if (size == strlen(word) && strncasecmp(name, word, size) == 0)
			return true;
		name += size;
	}
	return false;
}

bool mixer_is_input(const char *name)
{
	static const char *const inputs[] = { "mic",    "dmic",  "microphone", "line",
					      "linein", "aux",   "cd",         "capture",
					      "adc",    "input", "loopback",   "sidetone",
					      "beep" };

	if (has_word(name, "out"))
		return false; /* such as "Line Out" */
	for (size_t i = 0; i < ARRAY_COUNT(inputs); i++)
		if (has_word(name, inputs[i]))
			return true;
	return false;
}

static void open_control(snd_mixer_elem_t *control)
{
	long least, most;

	if (!snd_mixer_selem_is_active(control) ||
	    mixer_is_input(snd_mixer_selem_get_name(control)))
		return;
	if (snd_mixer_selem_has_playback_switch(control))
		snd_mixer_selem_set_playback_switch_all(control, 1);
	if (!snd_mixer_selem_has_playback_volume(control) ||
	    snd_mixer_selem_set_playback_dB_all(control, 0, -1) == 0)
		return;
	if (snd_mixer_selem_get_playback_volume_range(control, &least, &most) == 0)
		snd_mixer_selem_set_playback_volume_all(control, least + (most - least) / 5 * 4);
}

void mixer_open_up(void)
{
	snd_mixer_t *mixer = NULL;
	int code = snd_mixer_open(&mixer, 0);

	if (code == 0)
		code = snd_mixer_attach(mixer, "default");
	if (code == 0)
		code = snd_mixer_selem_register(mixer, NULL, NULL);
	if (code == 0)
		code = snd_mixer_load(mixer);
	for (snd_mixer_elem_t *control = code == 0 ? snd_mixer_first_elem(mixer) : NULL; control;
	     control = snd_mixer_elem_next(control))
		open_control(control);
	if (code < 0)
		log_debug("sound", "no mixer: %s", snd_strerror(code));
	if (mixer)
		snd_mixer_close(mixer);
}
