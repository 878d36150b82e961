/* Finds out what is wrong and what to do about it, in plain words for people who did not build the
 * terminal. Pure. docs/health.md has the rules as a table. */
#ifndef GOPURA_HEALTH_VERDICT_H
#define GOPURA_HEALTH_VERDICT_H

#include "health/gather.h"

enum level {
	LEVEL_OK,
	LEVEL_WARNING,  /* the terminal works; somebody should look at it */
	LEVEL_CRITICAL, /* visitors notice; somebody must come */
	LEVEL_COUNT
};

enum { FINDINGS_MAX = 24 };

struct finding {
	enum level level;
	const char *what;   /* what is wrong; static */
	char detail[256];   /* facts about it; may be "" */
	const char *action; /* what it means and what to do; static */
};

struct verdict {
	enum level level; /* the worst level of the findings */
	struct finding findings[FINDINGS_MAX];
	size_t count;
};

/* Judges a snapshot. Findings are ordered from the worst; beyond FINDINGS_MAX they are dropped. */
void verdict_judge(struct verdict *out, const struct snapshot *snapshot);

/* Writes a duration for people to out: "3 minutes", "2 days". */
void verdict_duration(char *out, size_t out_bytes, double seconds);

#endif
