/* The guided tours of the information database: docs/tours.md. */
#ifndef GOPURA_STORAGE_INFO_TOUR_H
#define GOPURA_STORAGE_INFO_TOUR_H

#include "storage/info.h"

struct info_stop {
	float eye_m[3], target_m[3];
	float stay_s,
		travel_s; /* stay 0: the tour passes without a stop; travel 0: chosen by distance */
	int part;         /* the part to highlight, or -1 */
	/* The way to it is a straight line at one speed, in travel_s, which is above 0. */
	bool is_even;
};

struct info_tour {
	const char *id;
	bool attract; /* runs in a loop while no visitor is present; its path is closed */
	uint32_t stop_count;
	struct info_stop stops[INFO_STOPS_MAX];
};

/* Tours; none in images before version 3. Borrowed until info_close; texts as from info_text. */
uint32_t info_tour_count(const struct info *info);
/* tour < info_tour_count(). */
const struct info_tour *info_tour(const struct info *info, uint32_t tour);
int info_find_tour(const struct info *info, const char *id); /* the tour's index, or -ENOENT */
/* Returns title, caption and thumbnail of a tour. */
struct info_text info_tour_text(const struct info *info, uint32_t tour, const char *language);
/* Returns the text at a stop, or "". */
const char *info_stop_caption(const struct info *info, uint32_t tour, uint32_t stop,
			      const char *language);

/* For opening: reads the tours, after parts and pictures are loaded. */
must_check int info_load_tours(struct info *info);
/* For closing: frees the tours. */
void info_drop_tours(struct info *info);

#endif
