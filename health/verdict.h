/* What is ill and how it is cured, in plain words for people who did not build the terminal. Pure.
 * docs/health.md has the rules as a table. */
#ifndef GOPURA_HEALTH_VERDICT_H
#define GOPURA_HEALTH_VERDICT_H

#include "health/gather.h"

enum level {
	LEVEL_WELL,
	LEVEL_REMARK, /* the terminal works; somebody should look */
	LEVEL_ILL,    /* visitors notice it: somebody must come */
	LEVEL_COUNT
};

enum { FINDINGS_MAX = 24 };

struct finding {
	enum level level;
	const char *what; /* static */
	char detail[256]; /* may be "" */
	const char *cure; /* static */
};

struct verdict {
	enum level level; /* the worst */
	struct finding findings[FINDINGS_MAX];
	size_t count;
};

/* Findings stand with the worst first. */
void verdict_judge(struct verdict *out, const struct snapshot *snapshot);

/* For people: "3 minutes", "2 days". */
void verdict_duration(char *out, size_t out_bytes, double seconds);

#endif
