/* The control by which a visitor chooses a layer of the scenery. */
#ifndef GOPURA_APP_VISIT_LAYER_CHOICE_H
#define GOPURA_APP_VISIT_LAYER_CHOICE_H

#include "app/view/exhibit.h"

/* Called before each frame: tells the overlay the layers' titles and which one is chosen. */
void layer_choice_show(const struct exhibit *shown);
/* Returns the title of a layer in a language, or in a related one, or in the first that the layer
 * has. Borrowed from the scenery. */
const char *layer_choice_title(const struct scenery *scenery, uint32_t layer, const char *language);

#endif
