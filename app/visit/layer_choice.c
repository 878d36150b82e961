/* Finds the titles of layers, and hands them to the overlay. */
#include "app/visit/layer_choice.h"

#include <string.h>

const char *layer_choice_title(const struct scenery *scenery, uint32_t layer, const char *language)
{
	const struct scenery_title *titles = &scenery->titles[scenery->layers[layer].first_title];
	const uint32_t count = scenery->layers[layer].title_count;
	const size_t size = strcspn(language, "-");

	for (uint32_t i = 0; i < count; i++)
		if (strcmp(titles[i].language, language) == 0)
			return titles[i].text;
	for (uint32_t i = 0; i < count; i++)
		if (strcspn(titles[i].language, "-") == size &&
		    strncmp(titles[i].language, language, size) == 0)
			return titles[i].text;
	return titles[0].text;
}

void layer_choice_show(const struct exhibit *shown)
{
	const struct scenery *scenery = shown->scene ? scene_scenery(shown->scene) : NULL;
	const char *language = information_view_language(shown->view);
	const char *titles[SCENERY_LAYERS_MAX];
	struct overlay *overlay = exhibit_overlay(shown);

	if (!overlay || !scenery)
		return;
	for (uint32_t i = 0; i < scenery->layer_count; i++)
		titles[i] = layer_choice_title(scenery, i, language ? language : "");
	overlay_show_choice(overlay, titles, scenery->layer_count, scene_layer(shown->scene));
}
