/* ALSA's simple mixer: controls by name, whatever the card has. */
#include "sound/mixer.h"

#include <alsa/asoundlib.h>

#include "base/log.h"

static void open_control(snd_mixer_elem_t *control)
{
	long least, most;

	if (!snd_mixer_selem_is_active(control))
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
