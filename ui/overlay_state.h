/* The overlay's state: all of its views. Private to ui/overlay*.c; tests look inside. */
#ifndef GOPURA_UI_OVERLAY_STATE_H
#define GOPURA_UI_OVERLAY_STATE_H

#include "ui/bar_view.h"
#include "ui/callouts_view.h"
#include "ui/card_view.h"
#include "ui/choice_view.h"
#include "ui/gallery_view.h"
#include "ui/help_view.h"
#include "ui/invitation_view.h"
#include "ui/languages_view.h"
#include "ui/measure_view.h"
#include "ui/overlay_data.h"
#include "ui/page_view.h"
#include "ui/paper.h"
#include "ui/parts.h"
#include "ui/question_view.h"
#include "ui/search_view.h"
#include "ui/tools_view.h"
#include "ui/tour_player_view.h"
#include "ui/tours_view.h"

struct overlay {
	int width_px, height_px;
	struct theme theme;
	struct overlay_comfort comfort;
	struct languages languages;
	struct picture_source pictures;
	struct parts parts;
	bool back;          /* there is a way back */
	struct paper paper; /* page and search stand on it */

	struct bar_view bar;
	struct callouts_view callouts;
	struct card_view card;
	struct choice_view choice;
	struct gallery_view gallery;
	struct help_view help;
	struct invitation_view invitation;
	struct languages_view languages_view;
	struct measure_view measure;
	struct page_view page;
	struct question_view question;
	struct search_view search;
	struct tools_view tools;
	struct tour_player_view tour;
	struct tours_view tours;

	int64_t then_ms; /* time of the last update; 0: none yet */
};

#endif
