/* Fences of a driver that draws on the processor, for the one context of a program.
 *
 * Each thread of Mesa's llvmpipe counts the fence of a picture up and then wakes those that wait
 * for it. It has passed before the last thread has done so, and is freed as soon as Mesa needs its
 * place, so that a thread which the machine stopped meanwhile writes to freed memory
 * (docs/picture.md, "In motion"). A fence that is kept here is not freed before a later one has
 * passed, which each thread comes to after it. So one is added wherever Mesa ends a picture: before
 * another framebuffer is bound, and before all is waited for.
 *
 * On a GPU, and where EGL has no fences, everything here does nothing. */
#ifndef GOPURA_RENDER_DISPLAY_FENCES_H
#define GOPURA_RENDER_DISPLAY_FENCES_H

#include <stdint.h>

/* Adds a fence after all that was drawn so far, and begins to draw it. Returns its number, from 1;
 * 0: there are none here. */
uint64_t fences_add(void);
/* Waits until the fence of that number, or one of the last few after it, has passed; 0 has. */
void fences_wait(uint64_t number);
/* Forgets all, before the context is destroyed; the next context begins anew. */
void fences_end(void);

#endif
