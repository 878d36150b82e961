/* Maps time to an offset on a 9 x 9 grid that is traversed row by row, forth and back. */
#include "render/display/shift.h"

enum { SIDE = 2 * SHIFT_MOST_PX + 1, PLACES = SIDE * SIDE };

void shift_at(int64_t time_ms, int shift_px[2])
{
	const int step = (int)(time_ms / SHIFT_STEP_MS % (2 * PLACES));
	/* the second half goes the way back */
	const int place = step < PLACES ? step : 2 * PLACES - 1 - step;
	const int row = place / SIDE, column = place % SIDE;

	shift_px[0] = (row % 2 == 0 ? column : SIDE - 1 - column) - SHIFT_MOST_PX;
	shift_px[1] = row - SHIFT_MOST_PX;
}
