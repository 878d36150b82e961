/* How malloc behaves in a program that draws. */
#ifndef GOPURA_APP_SETTINGS_HEAP_H
#define GOPURA_APP_SETTINGS_HEAP_H

/* To be called once, before threads are started. */
void heap_prepare(void);

#endif
