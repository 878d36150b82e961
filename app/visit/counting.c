/* Counts what visitors look at, with the time of day only if the clock can be trusted. */
#include "app/visit/counting.h"

#include "base/clock.h"

/* Returns the wall clock in seconds since 1970; 0 if it cannot be trusted. */
static int64_t wall_clock_s(void)
{
	return clock_wall_is_set() || clock_wall_is_plausible() ? clock_wall_s() : 0;
}

int counting_init(struct counting *counting, const struct exhibit *shown, const char *path,
		  const char *copy_path)
{
	*counting = (struct counting){ .shown = shown };
	return usage_create(&counting->usage, path, copy_path, wall_clock_s());
}

void counting_finish(struct counting *counting)
{
	usage_destroy(counting->usage);
	counting->usage = NULL;
}

void counting_part(struct counting *counting, enum usage_kind kind, int part)
{
	const struct info *info = exhibit_info(counting->shown);

	counting_id(counting, kind, info && part >= 0 ? info_part(info, (uint32_t)part)->id : "");
}

void counting_id(struct counting *counting, enum usage_kind kind, const char *id)
{
	const char *language = information_view_language(counting->shown->view);

	if (counting->usage)
		usage_add(counting->usage, kind, id, language ? language : "", wall_clock_s());
}

void counting_write(struct counting *counting)
{
	if (counting->usage)
		usage_write(counting->usage);
}
