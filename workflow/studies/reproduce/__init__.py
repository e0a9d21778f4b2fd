"""The paper from scratch: one module a section of it, which computes a `page.Section`; `report` makes the page."""
