"""Commands that only their users need, declared as entry points of the group ``granchain.tools``."""
