/* Counts what visitors look at, together with the language they use: storage/usage.h. */
#include "app/kiosk.h"
#include "base/clock.h"

int64_t counting_clock_s(void)
{
	return clock_wall_is_set() || clock_wall_is_plausible() ? clock_wall_s() : 0;
}

void counting_part(struct kiosk *kiosk, enum usage_kind kind, int part)
{
	const struct info *info = information_view_info(kiosk->shown.view);

	counting_id(kiosk, kind, info && part >= 0 ? info_part(info, (uint32_t)part)->id : "");
}

void counting_id(struct kiosk *kiosk, enum usage_kind kind, const char *id)
{
	const char *language =
		kiosk->shown.view ? information_view_language(kiosk->shown.view) : NULL;

	if (kiosk->usage)
		usage_add(kiosk->usage, kind, id, language ? language : "", counting_clock_s());
}
