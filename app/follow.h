/* Follows the releases of the museum server: remembers which one is shown (state.db), checks the
 * signed metadata, has the next release brought in the background, and switches to it at once and
 * whole. */
#ifndef GOPURA_APP_FOLLOW_H
#define GOPURA_APP_FOLLOW_H

#include "net/client.h"

struct follow;

struct follow_options {
	const char *state_path; /* state.db; copied */
	const char *trust_path; /* root/1.json to pin where the state has none; NULL: none */
	struct net_client *net; /* borrowed */
	/* Bring this release: at the start the remembered one, later each new one. follow_switched
	 * answers when it is shown. */
	void (*begin)(void *data, struct hash root, uint32_t root_bytes);
	void *data;
};

must_check int follow_create(struct follow **out, const struct follow_options *options);
void follow_destroy(struct follow *follow); /* NULL is fine */

/* Begins: shows the remembered release, if there is one. */
void follow_start(struct follow *follow);
void follow_meta(struct follow *follow, enum meta_role role, uint32_t version, struct bytes bytes);
/* The release that began last can be shown whole: remembers it, durably. On failure the one before
 * stays the one that is shown. */
must_check int follow_switched(struct follow *follow);
/* Why the last metadata was refused, for the health page; "" where it was not. */
const char *follow_refusal(const struct follow *follow);

#endif
