"""From what a learning management system lets an instructor download to notebooks in ``submitted``."""
