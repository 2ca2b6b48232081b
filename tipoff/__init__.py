"""Which velocity and which angular rates does a payload leave its rail with?"""
